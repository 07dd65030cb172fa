// SPDX-License-Identifier: Apache-2.0
// Scenes for the stresses, and a viewer's way through them: from a leaf to its tiles and to a frame.
#pragma once

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <stdexcept>

#include "client/decode/payload_decoder.h"
#include "client/warp/cpu_warper.h"
#include "common/codec/tile_codec.h"
#include "server/encode/tile_maker.h"
#include "server/scene/reference_image.h"
#include "server/scene/scene_frame.h"
#include "tests/stability/stress.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield::stability {

using Long3 = glm::vec<3, long double>;

inline std::shared_ptr<const Scene> build_scene(Model model) {
  auto scene = Scene::build(std::move(model));
  if (!scene) throw std::runtime_error(scene.error().message);
  return *scene;
}

/// Placed as `world_from_mesh` says.
inline Model placed(Model model, const glm::dmat4& world_from_mesh) {
  for (MeshInstance& instance : model.instances) instance.world_from_mesh = world_from_mesh * instance.world_from_mesh;
  return model;
}
inline glm::dmat4 moved(const glm::dvec3& by) {
  return glm::translate(glm::dmat4(1), by);
}
inline glm::dmat4 scaled(double by) {
  return glm::scale(glm::dmat4(1), glm::dvec3(by));
}

inline const Box kHall{{-6, -0.5, -6}, {6, 2, 6}};

/// A hall of 12 m with pillars on one side only, so that the cell tree divides and shells have something to hide.
inline Model hall_model() {
  test::Blocks blocks;
  blocks.room(kHall, {180, 190, 170, 255}, 6);
  for (int z = -3; z <= 3; ++z)
    for (int x = 0; x <= 3; ++x) {
      const glm::dvec3 corner(1.5 * x, -0.5, 1.5 * z);
      blocks.box({corner, corner + glm::dvec3(0.25, 2.5, 0.25)}, {140, 80, 70, 255}, 3);
    }
  return blocks.model();
}
/// A closed room of the given size.
inline Model room_model(const Box& box, int pieces = 6) {
  return test::Blocks().room(box, {180, 190, 170, 255}, pieces).model();
}

inline const glm::dvec3 kHallEyes[] = {{0.875, 1.0, 0.875}, {-3.25, 0.75, 2.5}, {-0.125, 1.25, -4.0}};
inline const Display kSmallDisplay{96, 64};

inline ImpostorSettings hall_settings(double scale = 1) {
  ImpostorSettings settings;
  settings.display = {320, 180};
  settings.face_tiles = 3;
  settings.delta_views = 3;
  settings.near_triangles = 300;
  settings.finest_side_m = 0.125 * scale;
  return settings;
}

/// What a viewer gets: everything that may be compared bit by bit.
struct Visit {
  CellId leaf;
  std::vector<NeededTile> needed;
  std::vector<Bytes> tiles;        // the first of them, encoded
  std::vector<std::uint8_t> rays;  // the scene cast from the eye
  client::LeafView view;
};

/// `eye` in the scene frame.
inline Visit visit(const std::shared_ptr<const Scene>& scene, const ImpostorSources& sources, const ImpostorSettings& settings,
                   const glm::dvec3& eye, std::size_t most_tiles) {
  Visit result;
  result.leaf = sources.leaves->leaf_at(eye, nullptr).value();
  const auto plan = sources.leaves->plan(result.leaf, nullptr).value();
  result.needed = plan->tiles;
  const NestedShells shells{CellGrid{settings.finest_side_m}, settings.kappa};
  const client::PayloadDecoder decoder(shells.grid, client::DecodeForm::kSplats, [](ByteView bytes) { return decode_tile(bytes); });
  result.view.leaf = result.leaf;
  result.view.leaf_box = shells.grid.box(result.leaf);
  result.view.near_region = shells.near_region(result.leaf);
  result.view.is_complete = true;
  result.view.background_visible = plan->background_visible;
  result.view.sky = plan->sky;
  result.view.background = scene->background();
  for (const NeededTile& tile : plan->tiles) {
    if (result.tiles.size() == most_tiles) break;
    const auto made = sources.tiles->make(tile.id, nullptr).value();
    result.tiles.push_back(*made->bytes);
    if (made->bytes->empty()) continue;
    result.view.tiles.push_back(decoder.decode({{client::PayloadKind::kTile, made->hash}, made->bytes}).value().tile);
  }
  result.rays = render_reference(*scene, {eye, glm::angleAxis(0.4, glm::dvec3(0, 1, 0))}, kSmallDisplay, 1).rgb;
  return result;
}

inline bool is_same(const NeededTile& a, const NeededTile& b) {
  return a.id == b.id && a.view_share == b.view_share;
}

/// How many of the things that two visits hold differ.
inline std::uint64_t differences(const Visit& a, const Visit& b) {
  std::uint64_t count = a.leaf != b.leaf;
  count += !std::equal(a.needed.begin(), a.needed.end(), b.needed.begin(), b.needed.end(), is_same);
  count += a.tiles.size() != b.tiles.size();
  for (std::size_t k = 0; k < std::min(a.tiles.size(), b.tiles.size()); ++k) count += a.tiles[k] != b.tiles[k];
  for (std::size_t k = 0; k < a.rays.size(); ++k) count += a.rays[k] != b.rays[k];
  return count;
}
inline std::uint64_t compared(const Visit& a) {
  return 3 + a.tiles.size() + a.rays.size();
}

/// Half the distance from the float nearest to |x| to the next: what rounding to float may move x by.
inline double half_float_ulp(double x) {
  const float f = std::fabs(static_cast<float>(x));
  return 0.5 * (static_cast<double>(std::nextafter(f, std::numeric_limits<float>::infinity())) - static_cast<double>(f));
}
inline double half_double_ulp(double x) {
  const double f = std::abs(x);
  return 0.5 * (std::nextafter(f, std::numeric_limits<double>::infinity()) - f);
}

/// What the distance t of a first hit on a plane may be off by, as a multiple of 1/cos, cos the cosine between the ray
/// and the plane's normal.
///
/// t = n·(p − o)/(n·D). The roundings, u = 2⁻²⁴ each: of o to float (`eye`: at most half_float_ulp per axis, √3 in all),
/// of D to float (u relative, moves the hit by u·t across and so along n by at most u·t), of p − o (1), of n = e × e' (3
/// each component, relative to |e||e'|: right triangles of the rooms, so relative to |n|), of the two dot products (3
/// each) and of the quotient (3: Embree's reciprocal is a Newton step). 1 + 1 + 3 + 3 + 3 + 3 + 3 = 17 < 32 roundings, of
/// terms not larger than |n| times the distance to a vertex of the triangle, at most `reach`.
/// `surface`: how far the plane itself stands from where it should.
inline double plane_distance_bound(double surface, const glm::dvec3& eye, double reach) {
  const double eye_m = std::sqrt(3.0) * std::max({half_float_ulp(eye.x), half_float_ulp(eye.y), half_float_ulp(eye.z)});
  return surface + eye_m + 32 * 0x1p-24 * reach;
}

/// Where a ray from inside kHall · scale + by leaves it.
struct WallDistance {
  long double distance = INFINITY;
  double cosine = 1;  // between the ray, of length 1, and the wall's normal
};
inline WallDistance exact_wall_distance(double scale, const glm::dvec3& by, const glm::dvec3& world, const glm::dvec3& direction) {
  WallDistance found;
  for (int a = 0; a < 3; ++a) {
    const long double wall = static_cast<long double>(scale) * static_cast<long double>(direction[a] > 0 ? kHall.max[a] : kHall.min[a]) +
                             static_cast<long double>(by[a]);
    const long double t = (wall - static_cast<long double>(world[a])) / static_cast<long double>(direction[a]);
    if (t < found.distance) found = {t, std::abs(direction[a])};
  }
  return found;
}

/// First hits in a room that is kHall · scale + by, from everywhere in it and in all directions, against long double.
/// Walls stand off by the position grid: half a step, and a sixteenth for the offset of the mesh.
inline WorstError hits_in_a_room(double scale, const glm::dvec3& by, int packets) {
  const Model model = placed(room_model(kHall), moved(by) * scaled(scale));
  const auto scene = build_scene(model);
  const double grid_m = choose_scene_frame(model.bounds()).step_m * (1.0 / 2 + 1.0 / 16), reach = 18.0 * scale;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.05, 0.95), signed_unit(-1, 1);
  WorstError worst;
  for (int k = 0; k < packets; ++k) {
    const glm::dvec3 world = by + scale * (kHall.min + kHall.extent() * glm::dvec3(unit(random), unit(random), unit(random)));
    const glm::dvec3 eye = world - scene->origin();
    RayPacket rays{};
    HitPacket hits;
    glm::dvec3 directions[kPacketSize];
    for (int lane = 0; lane < kPacketSize; ++lane) {
      directions[lane] = glm::normalize(glm::dvec3(signed_unit(random), signed_unit(random), signed_unit(random)));
      set_ray(rays, lane, eye, directions[lane], {});
    }
    rays.active = 0xffff;
    scene->intersect(rays, hits);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const WallDistance exact = exact_wall_distance(scale, by, world, directions[lane]);
      worst.add(hits.part[lane] == kNoHit ? INFINITY : static_cast<double>(hits.distance[lane] - exact.distance),
                plane_distance_bound(grid_m, eye, reach) / exact.cosine);
    }
  }
  return worst;
}

}  // namespace farfield::stability

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "server/model/generate.h"
#include "server/visibility/box_visibility.h"
#include "server/visibility/sphere_rays.h"
#include "server/visibility/standpoints.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::Blocks;
using test::PlacedScene;

// Two sets of surfaces with a texture of its own for the second, so that no chunk holds some of both.
PlacedScene build_apart(Model model, Model apart) {
  TextureImage white{1, 1, {255, 255, 255, 255}, "white"};
  model.textures.push_back(white);
  Material material;
  material.texture = 0;
  model.materials.push_back(material);
  apart.meshes[0].material = 1;
  model.meshes.push_back(apart.meshes[0]);
  model.instances.push_back({1, glm::dmat4(1)});
  auto scene = Scene::build(std::move(model));
  if (!scene) throw std::runtime_error(scene.error().message);
  return {*scene};
}

std::vector<std::uint32_t> chunks_within(const Scene& scene, const Box& box) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t c = 0; c < scene.chunks().size(); ++c)
    if (box.contains(scene.chunks()[c].bounds)) found.push_back(c);
  return found;
}

bool lists(const BoxVisibility& seen, std::uint32_t chunk) {
  return std::find(seen.near_chunks.begin(), seen.near_chunks.end(), chunk) != seen.near_chunks.end();
}

TEST(Standpoints, TheInsideOfAClosedBoxIsNotFree) {
  const PlacedScene placed = Blocks().quad({-20, -2, 20}, {40, 0, 0}, {0, 0, -40}, {90, 90, 90, 255}).box({{-1, -1, -1}, {1, 1, 1}}).build();
  EXPECT_FALSE(is_free(*placed.scene, placed.at(glm::dvec3(0))));
  EXPECT_FALSE(is_free(*placed.scene, placed.at({0.9, -0.9, 0.9})));
  EXPECT_TRUE(is_free(*placed.scene, placed.at({3, 0, 0})));
  EXPECT_TRUE(is_free(*placed.scene, placed.at({0, 50, 0})));
  EXPECT_FALSE(is_free(*placed.scene, placed.at({5, -2.5, 5}))) << "below the ground";
}

TEST(Standpoints, AreTheFreePointsOfTheLattice) {
  const PlacedScene placed = Blocks().room({{-4, -4, -4}, {4, 4, 4}}).box({{0.25, -4, -4}, {4, 4, 4}}).build();
  const Standpoints all = find_standpoints(*placed.scene, placed.at(test::cube({-2, 0, 0}, 1)));
  EXPECT_EQ(all.points.size(), 27u);
  const Standpoints half = find_standpoints(*placed.scene, placed.at(test::cube({0, 0, 0}, 2)));
  EXPECT_EQ(half.points.size(), 18u) << "the third inside the block is left out";
  EXPECT_FALSE(half.all_blocked);
  const Standpoints none = find_standpoints(*placed.scene, placed.at(test::cube({2, 0, 0}, 1)));
  EXPECT_TRUE(none.all_blocked);
  EXPECT_EQ(none.points.size(), 27u) << "never empty";
}

TEST(FacesAway, IsTrueOnlyIfEveryTriangleFacesAwayFromEveryViewpoint) {
  Blocks blocks;
  for (int k = 0; k < 8; ++k) blocks.box(test::cube({6.0 * k, 0, 3.0 * (k % 3)}, 2 + k % 2), {150, 150, 150, 255}, 6);
  const PlacedScene placed = blocks.build();
  const Scene& scene = *placed.scene;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  int away = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const glm::dvec3 center = placed.at(glm::dvec3(-20 + 80 * unit(random), -20 + 40 * unit(random), -20 + 40 * unit(random)));
    const Box viewpoints = test::cube(center, 0.5 + unit(random));
    for (std::uint32_t c = 0; c < scene.chunks().size(); ++c) {
      const SceneChunk& chunk = scene.chunks()[c];
      if (!faces_away(chunk, viewpoints)) continue;
      ++away;
      const Chunk geometry = scene.chunk_geometry(c);
      const auto vertex = [&](std::size_t i) {
        return glm::dvec3(chunk.scene_from_chunk * glm::dvec4(glm::dvec3(geometry.vertices[geometry.indices[i]].position), 1));
      };
      for (std::size_t t = 0; t + 2 < geometry.indices.size(); t += 3) {
        const glm::dvec3 a = vertex(t), normal = glm::cross(vertex(t + 1) - a, vertex(t + 2) - a);
        for (int corner = 0; corner < 8; ++corner) {
          const glm::dvec3 eye = viewpoints.min + viewpoints.extent() * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2);
          ASSERT_LT(glm::dot(normal, eye - a), 0);
        }
      }
    }
  }
  EXPECT_GT(away, 0) << "the test must find something to recognise";
}

TEST(FacesAway, AWallTurnedAwayIsRecognised) {
  const PlacedScene placed = Blocks().quad({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {150, 150, 150, 255}, 4).build();
  const SceneChunk& wall = placed.scene->chunks()[0];
  EXPECT_TRUE(faces_away(wall, placed.at(test::cube({1, 1, -6}, 1))));
  EXPECT_FALSE(faces_away(wall, placed.at(test::cube({1, 1, 6}, 1))));
  EXPECT_FALSE(faces_away(wall, placed.at(test::cube({1, 1, 0}, 1)))) << "viewpoints on both sides";
}

TEST(BoxVisibility, ListsTheChunksThatRandomRaysHit) {
  auto model = generate_model("pipes", 20000, 1);
  ASSERT_TRUE(model);
  auto built = Scene::build(std::move(*model));
  ASSERT_TRUE(built);
  const Scene& scene = **built;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1), signed_unit(-1, 1);
  const glm::dvec3 middle = scene.bounds().center(), extent = scene.bounds().extent();
  std::size_t hits = 0, listed = 0;
  for (int trial = 0; trial < 4; ++trial) {
    const glm::dvec3 center(middle.x + 0.3 * extent.x * signed_unit(random), 1.7 - scene.origin().y, middle.z + 0.3 * extent.z * signed_unit(random));
    const Box viewpoints = test::cube(center, 0.5), near_box = viewpoints.grown(1.0);
    const BoxVisibility seen = probe_visibility(scene, viewpoints, near_box, {});
    std::vector<bool> is_listed(scene.chunks().size(), false);
    for (const std::uint32_t c : seen.near_chunks) is_listed[c] = true;
    for (int k = 0; k < 300; ++k) {
      const glm::dvec3 eye = viewpoints.min + viewpoints.extent() * glm::dvec3(unit(random), unit(random), unit(random));
      if (!is_free(scene, eye)) continue;
      RayPacket rays;
      HitPacket found;
      for (int lane = 0; lane < kPacketSize; ++lane)
        set_ray(rays, lane, eye, glm::dvec3(signed_unit(random), signed_unit(random), signed_unit(random)), {});
      scene.intersect_scattered(rays, found);
      for (int lane = 0; lane < kPacketSize; ++lane) {
        if (found.part[lane] == kNoHit || !near_box.contains(hit_point(rays, found, lane))) continue;
        ++hits;
        listed += is_listed[scene.chunk_of(found.part[lane], found.primitive[lane])];
      }
    }
  }
  ASSERT_GT(hits, 500u);
  EXPECT_GE(static_cast<double>(listed), 0.995 * static_cast<double>(hits)) << listed << " of " << hits;
}

TEST(BoxVisibility, WhatStandsInAClosedRoomIsNotListedFromOutside) {
  Model rooms = Blocks().room({{-8, -8, -8}, {8, 8, 8}}).box({{2, -2, -2}, {6, 2, 2}}).room({{2.25, -1.75, -1.75}, {5.75, 1.75, 1.75}}).model();
  const Box treasure{{3, -0.5, -0.5}, {4, 0.5, 0.5}};
  const PlacedScene placed = build_apart(std::move(rooms), Blocks().box(treasure).model());
  const std::vector<std::uint32_t> hidden = chunks_within(*placed.scene, placed.at(treasure.grown(0.01)));
  ASSERT_FALSE(hidden.empty());
  const Box outside = placed.at(test::cube({-2, 0, 0}, 2)), inside = placed.at(test::cube({5, 1, 1}, 0.25));
  const BoxVisibility from_outside = probe_visibility(*placed.scene, outside, outside.grown(8), {});
  const BoxVisibility from_inside = probe_visibility(*placed.scene, inside, inside.grown(8), {});
  for (const std::uint32_t chunk : hidden) {
    EXPECT_FALSE(lists(from_outside, chunk));
    EXPECT_TRUE(lists(from_inside, chunk));
  }
}

TEST(BoxVisibility, AWireThatNoProbeRayMeetsIsFound) {
  const Box wire{{2.4375, -1, 0.296875}, {2.4375, 1, 0.298828125}};
  Model thread = Blocks().quad({2.4375f, -1, 0.296875f}, {0, 0, 0.001953125f}, {0, 2, 0}, {250, 250, 250, 255}).model();
  const PlacedScene placed = build_apart(Blocks().room({{-4, -4, -4}, {4, 4, 4}}).model(), std::move(thread));
  const std::vector<std::uint32_t> thin = chunks_within(*placed.scene, placed.at(wire.grown(0.01)));
  ASSERT_EQ(thin.size(), 1u);
  const Box viewpoints = placed.at(test::cube({0, 0, 0}, 1));
  const BoxVisibility coarse = probe_visibility(*placed.scene, viewpoints, viewpoints.grown(3.25), {.edge = 4, .is_thorough = false});
  const BoxVisibility thorough = probe_visibility(*placed.scene, viewpoints, viewpoints.grown(3.25), {.edge = 4});
  EXPECT_FALSE(lists(coarse, thin[0])) << "a probe this coarse should miss it, or this test shows nothing";
  EXPECT_TRUE(lists(thorough, thin[0]));
}

TEST(BoxVisibility, FarHitsAreBeyondTheNearBoxAndFillTheSphere) {
  const PlacedScene placed = Blocks().room({{-4, -4, -4}, {4, 4, 4}}).build();
  const Box viewpoints = placed.at(test::cube({0, 0, 0}, 1)), near_box = viewpoints.grown(2);
  const BoxVisibility seen = probe_visibility(*placed.scene, viewpoints, near_box, {});
  double sphere = 0;
  for (const FarHit& hit : seen.far_hits) {
    ASSERT_FALSE(near_box.contains(glm::dvec3(hit.point)));
    sphere += hit.solid_angle;
  }
  EXPECT_NEAR(sphere / static_cast<double>(seen.viewpoints), 4 * M_PI, 0.01 * 4 * M_PI);
  EXPECT_FALSE(seen.escapes);
  EXPECT_TRUE(seen.is_converged);
  EXPECT_FALSE(seen.is_cut_short);
}

// Plates of which only viewers in a few hundredths of the box see something, each through a hole in a wall. A ray meets most
// of them, though the probe is coarse: tiles that hold such things would be missed by those who walk there.
TEST(BoxVisibility, NearlyAllThatShowsThroughGapsFromAFewPlacesIsFound) {
  constexpr int kScenes = 40;
  constexpr double kWall = 2, kPlateX = 6, kHole = 0.15, kPlate = 0.2;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(-0.4, 0.4);
  int found = 0;
  for (int k = 0; k < kScenes; ++k) {
    // A place of the box from which the plate's centre shows through the hole's.
    const glm::dvec3 place(0, anywhere(random), anywhere(random)), hole(kWall, anywhere(random), anywhere(random));
    const glm::dvec3 plate = place + (hole - place) * (kPlateX / kWall) - glm::dvec3(0, kPlate / 2, kPlate / 2);
    const glm::dvec2 low(hole.y - kHole / 2, hole.z - kHole / 2), high = low + kHole;
    const glm::u8vec4 grey(90, 90, 90, 255);
    const PlacedScene placed = Blocks().room({{-10, -10, -10}, {10, 10, 10}})
                                   .quad({kWall, -10, -10}, {0, low.x + 10, 0}, {0, 0, 20}, grey)
                                   .quad({kWall, high.x, -10}, {0, 10 - high.x, 0}, {0, 0, 20}, grey)
                                   .quad({kWall, low.x, -10}, {0, kHole, 0}, {0, 0, low.y + 10}, grey)
                                   .quad({kWall, low.x, high.y}, {0, kHole, 0}, {0, 0, 10 - high.y}, grey)
                                   .quad(plate, {0, kPlate, 0}, {0, 0, kPlate}, grey)
                                   .build();
    const Box viewpoints = placed.at(test::cube({0, 0, 0}, 1));
    const BoxVisibility seen = probe_visibility(*placed.scene, viewpoints, viewpoints.grown(1), {.edge = 40});
    found += std::any_of(seen.far_hits.begin(), seen.far_hits.end(),
                         [&](const FarHit& hit) { return std::abs(hit.point.x - placed.at(plate).x) < 0.01; });
  }
  EXPECT_GE(10 * found, 9 * kScenes);  // without rays beside rims half of them
}

TEST(BoxVisibility, TheSkyIsWhereRaysEscape) {
  const PlacedScene placed = Blocks().quad({-50, -2, 50}, {100, 0, 0}, {0, 0, -100}, {90, 90, 90, 255}).build();
  const Box viewpoints = placed.at(test::cube({0, 0, 0}, 1));
  const BoxVisibility seen = probe_visibility(*placed.scene, viewpoints, viewpoints.grown(2), {});
  EXPECT_TRUE(seen.escapes);
  EXPECT_TRUE(seen.sky.contains({0.2, 1, 0.3}));
  EXPECT_TRUE(seen.sky.contains({1, 0.3, 0.1}));
  EXPECT_FALSE(seen.sky.contains({0.2, -1, 0.3}));
}

TEST(BoxVisibility, StopsWhenEnoughIsKnownOrNobodyWaits) {
  const PlacedScene placed = test::pillar_room().build();
  const Box viewpoints = placed.at(test::cube({0, 0, 0}, 1)), near_box = viewpoints.grown(5);
  const BoxVisibility whole = probe_visibility(*placed.scene, viewpoints, near_box, {});
  const BoxVisibility enough = probe_visibility(*placed.scene, viewpoints, near_box, {.enough_triangles = 10});
  EXPECT_TRUE(enough.is_cut_short);
  EXPECT_LT(enough.viewpoints, whole.viewpoints);
  const std::atomic<bool> cancelled = true;
  const BoxVisibility stopped = probe_visibility(*placed.scene, viewpoints, near_box, {.cancel = &cancelled});
  EXPECT_TRUE(stopped.is_cut_short);
  EXPECT_LE(stopped.viewpoints, 1u);
}

TEST(BoxVisibility, IsTheSameEveryTime) {
  const PlacedScene placed = test::pillar_room().build();
  const Box viewpoints = placed.at(test::cube({0.25, 0, 1}, 1)), near_box = viewpoints.grown(2);
  const BoxVisibility a = probe_visibility(*placed.scene, viewpoints, near_box, {}), b = probe_visibility(*placed.scene, viewpoints, near_box, {});
  EXPECT_EQ(a.near_chunks, b.near_chunks);
  EXPECT_EQ(a.far_hits.size(), b.far_hits.size());
  EXPECT_TRUE(std::equal(a.sky.bytes().begin(), a.sky.bytes().end(), b.sky.bytes().begin()));
}

}  // namespace
}  // namespace farfield

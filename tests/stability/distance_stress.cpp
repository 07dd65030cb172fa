// SPDX-License-Identifier: Apache-2.0
// The nearest and the farthest thing in one picture, and rays that all but miss a plane.
#include <fmt/format.h>

#include <bit>

#include "client/warp/splat_key.h"
#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

// A wall 2^-14 … 1/2 m in front of the eye and one 8192 m behind it, seen past its edge: a ratio of 1.3·10^8. The near
// wall stands at zero, where floats are fine enough for such an eye. Only one axis counts, as both walls stand across it:
// of plane_distance_bound() remain the eye's rounding along it and the 32 roundings relative to the distance.
StressRow near_and_far(const Effort&) {
  const double far_m = 8192;
  const auto scene = build_scene(test::Blocks()
                                     .quad({0, 0, 0}, {0, 64, 0}, {0, 0, 64}, {200, 100, 50, 255})
                                     .quad({8192, 0, 128}, {0, 4096, 0}, {0, 0, 4096}, {50, 100, 200, 255})
                                     .model());
  WorstError worst;
  for (int k = 14; k >= 1; --k) {
    const double near_m = std::ldexp(1.0, -k);
    for (const bool is_near : {true, false}) {
      const glm::dvec3 eye = glm::dvec3(-near_m, 32, is_near ? 32.0 : 64.5) - scene->origin();
      const double exact = is_near ? near_m : far_m + near_m;
      RayPacket rays{};
      HitPacket hits;
      for (int lane = 0; lane < kPacketSize; ++lane) set_ray(rays, lane, eye, {1, 0.01 * lane, 0.01 + 0.01 * lane}, {});
      rays.active = 0xffff;
      scene->intersect(rays, hits);
      for (int lane = 0; lane < kPacketSize; ++lane)
        worst.add(hits.part[lane] == kNoHit ? INFINITY : hits.distance[lane] - exact, half_float_ulp(eye.x) + 32 * 0x1p-24 * exact);
    }
  }
  return worst.in_parts_of_bound("first hits from 2^-14 to 2^13 m in one scene", "exact distances");
}

// Anywhere else an eye cannot stand nearer to a wall than floats of the scene's extent tell apart: the whole promise.
StressRow anywhere(const Effort& effort) {
  const double extent = 1e5;
  const Box box{{0, 0, 0}, glm::dvec3(extent)};
  const Model model = room_model(box, 4);
  const auto scene = build_scene(model);
  const double step = choose_scene_frame(model.bounds()).step_m;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.1, 0.9);
  WorstError worst;
  for (int k = 0; k < (effort.is_full ? 20000 : 2000); ++k) {
    const double near_m = extent * std::pow(10.0, -8 * unit(random));
    const glm::dvec3 world(extent - near_m, extent * unit(random), extent * unit(random));
    RayPacket rays{};
    HitPacket hits;
    for (int l = 0; l < kPacketSize; ++l) set_ray(rays, l, world - scene->origin(), {l % 2 ? -1.0 : 1.0, 1e-3 * l, 2e-3 * l}, {});
    rays.active = 0xffff;
    scene->intersect(rays, hits);
    // Where the eye's rounding may carry it through the wall nothing is promised of the rays towards it.
    const double bound = plane_distance_bound(step / 2, world - scene->origin(), 2 * extent);
    for (int l = 0; l < kPacketSize; ++l) {
      const double exact = l % 2 ? extent - near_m : near_m;
      if (exact <= bound) continue;
      worst.add(hits.part[l] == kNoHit ? INFINITY : hits.distance[l] - exact, bound);
    }
  }
  return worst.in_parts_of_bound("first hits from 10^-3 to 10^5 m in a room of 10^5 m", "exact distances");
}

// near_plane/z as the depth buffer and the warper's keys hold it: the nearer of two surfaces 2^-21 apart, relatively, wins
// at any distance. z and the quotient are rounded, of both surfaces: four times 2^-24, less than the difference.
StressRow depth_order(const Effort&) {
  WorstError worst;
  for (double z = 1e-2; z < 2e6; z *= 1.0078125) {
    const float near = 0.01f / static_cast<float>(z), far = 0.01f / static_cast<float>(z * (1 + 0x1p-21));
    worst.count(!(near > far));
    worst.count(!(client::make_key(client::key_high(near), 0) > client::make_key(client::key_high(far), 0xffffffu)));
    worst.count(std::abs(client::key_disparity(client::make_key(client::key_high(near), 5)) - near) > 0);
  }
  return worst.row("depths from 10^-2 to 2·10^6 m, 2^-21 apart", "their order", "wrong", 0);
}

// A level floor seen at 10^-1 … 10^-6 rad from 1 m above, out to the distance of 1/angle. Its normal is exact, as are the
// products with zero: difference, two products and a quotient of three roundings remain, each relative to the distance.
StressRow grazing_level(int exponent, int packets) {
  const double angle = std::pow(10.0, -exponent);
  const auto edge = static_cast<float>(std::exp2(std::ceil(std::log2(1.2 / angle))));
  const auto scene =
      build_scene(test::Blocks().quad({-edge, 0, -edge}, {0, 0, 2 * edge}, {2 * edge, 0, 0}, {100, 100, 100, 255}, 2).model());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> turn(0, 2 * 3.14159265358979323846);
  WorstError worst;
  for (int k = 0; k < packets; ++k) {
    RayPacket rays{};
    HitPacket hits;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const double around = turn(random);
      set_ray(rays, lane, glm::dvec3(0, 1 + 0.1 / 3, 0) - scene->origin(), {std::cos(around), -angle, std::sin(around)}, {});
    }
    rays.active = 0xffff;
    scene->intersect(rays, hits);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      // Against the ray as it was cast: its direction in floats.
      const long double exact = static_cast<long double>(rays.origin_y[lane]) / -static_cast<long double>(rays.direction_y[lane]);
      worst.add(hits.part[lane] == kNoHit ? INFINITY : static_cast<double>(hits.distance[lane] - exact),
                6 * 0x1p-24 * static_cast<double>(exact));
    }
  }
  return worst.in_parts_of_bound(fmt::format("a level floor seen at 10^-{} rad", exponent), "long double");
}

// The same of one large slanted triangle. Its normal is rounded too: of plane_distance_bound()'s 32 roundings, 17 of them
// counted there, all are relative to the distance of its vertices, and the cosine they are divided by, the angle itself, is
// off by as many. At 10^-6 rad that is as much as the angle, and nothing can be promised.
StressRow grazing_slanted(int exponent, int packets) {
  const double angle = std::pow(10.0, -exponent);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, 1, -0.2)), along = glm::normalize(glm::cross(normal, glm::dvec3(0, 0, 1)));
  const glm::dvec3 across = glm::cross(normal, along);
  const double edge = std::exp2(std::ceil(std::log2(4.0 / angle)));
  const auto scene = build_scene(
      test::Blocks().triangle(-edge * along - edge * across, 3 * edge * along - edge * across, -edge * along + 3 * edge * across).model());
  const Chunk chunk = scene->chunk_geometry(0);
  Long3 corner[3];
  for (std::size_t k = 0; k < 3; ++k)
    corner[k] = Long3(scene->chunks()[0].scene_from_chunk * glm::dvec4(chunk.vertices[chunk.indices[k]].position, 1));
  const Long3 n = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> turn(0, 2 * 3.14159265358979323846), reach_share(0.1, 0.3);
  WorstError worst;
  for (int k = 0; k < packets; ++k) {
    const Long3 middle = (corner[0] + corner[1] + corner[2]) / 3.0L;
    const glm::dvec3 side(n.y > 0 ? n : -n);
    RayPacket rays{};
    HitPacket hits;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const double around = turn(random);
      // So high that the hit is about a fifth of an edge away.
      const double height = reach_share(random) * edge * angle;
      set_ray(rays, lane, glm::dvec3(middle) + height * side, std::cos(around) * along + std::sin(around) * across - angle * side, {});
    }
    rays.active = 0xffff;
    scene->intersect_scattered(rays, hits);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const Long3 origin(rays.origin_x[lane], rays.origin_y[lane], rays.origin_z[lane]);
      const Long3 direction(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
      const long double facing = glm::dot(n, direction), exact = glm::dot(n, corner[0] - origin) / facing;
      const double cosine = static_cast<double>(std::abs(facing)), roundings = 32 * 0x1p-24 / cosine;
      if (!(exact > 0) || roundings > 0.5) continue;
      worst.add(hits.part[lane] == kNoHit ? INFINITY : static_cast<double>(hits.distance[lane] - exact),
                roundings * 3 * edge / (1 - roundings));
    }
  }
  return worst.in_parts_of_bound(fmt::format("a slanted triangle seen at 10^-{} rad", exponent), "long double");
}

}  // namespace

Rows stress_distances(const Effort& effort) {
  Rows rows{near_and_far(effort), anywhere(effort), depth_order(effort)};
  const int packets = effort.is_full ? 5000 : 500;
  for (int exponent = 1; exponent <= 6; ++exponent) rows.push_back(grazing_level(exponent, packets));
  for (int exponent = 1; exponent <= 5; ++exponent) rows.push_back(grazing_slanted(exponent, packets));
  return rows;
}

}  // namespace farfield::stability

// SPDX-License-Identifier: Apache-2.0
// Eyes where a decision changes: on the borders of cells, and on surfaces.
#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

// Corners, edges and faces of a leaf, and one double before and after each. Cells are half open, so each such point has
// one leaf, whose box holds it; and the leaf's tiles, warped to that very point, leave no pixel without a finite depth.
Rows cell_borders(const Effort& effort) {
  const auto scene = build_scene(hall_model());
  const ImpostorSettings settings = hall_settings();
  const ImpostorSources sources = make_impostor_sources(scene, settings);
  const CellGrid grid{settings.finest_side_m};
  const CellId leaf = sources.leaves->leaf_at(kHallEyes[0] - scene->origin(), nullptr).value();
  const Box box = grid.box(leaf);
  WorstError held, finite;
  client::CpuWarper warper({.samples_per_pixel = 1, .threads = 1});
  const Visit home = visit(scene, sources, settings, box.center(), effort.is_full ? 10000 : 60);
  for (int place = 0; place < 27; ++place) {
    glm::dvec3 eye;
    const int at[3] = {place % 3, place / 3 % 3, place / 9};
    for (int a = 0; a < 3; ++a) eye[a] = at[a] == 0 ? box.min[a] : at[a] == 1 ? box.center()[a] : box.max[a];
    for (int step = -1; step <= 1; ++step) {
      glm::dvec3 point = eye;
      for (int a = 0; a < 3; ++a)
        if (step != 0) point[a] = std::nextafter(point[a], step * INFINITY);
      const CellId found = sources.leaves->leaf_at(point, nullptr).value();
      held.count(!grid.box(found).contains(point));
      held.count((found == leaf) != box.contains(point));
    }
    client::Frame frame;
    warper.draw(home.view, {eye, glm::angleAxis(0.7 * place, glm::normalize(glm::dvec3(1, 2, 3)))}, kSmallDisplay, nullptr, frame);
    for (const float disparity : frame.disparity) finite.count(!(disparity >= 0 && std::isfinite(disparity)));
  }
  return {held.row("eyes on corners, edges and faces of a leaf, and a double beside", "the box that holds them", "other leaves", 0),
          finite.row("frames from there, with the leaf's own tiles", "finite depths", "pixels without", 0)};
}

// An eye in the very plane of the floor, of a wall, or of both or three. Of rays that leave the surface the first hit is the
// wall across, at its exact distance, never the surface itself at distance 0.
StressRow on_surfaces(const Effort& effort) {
  const auto scene = build_scene(room_model(kHall, 4));
  const glm::dvec3 origin = scene->origin();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.05, 0.95), signed_unit(-1, 1);
  WorstError worst;
  for (int k = 0; k < (effort.is_full ? 50000 : 3000); ++k) {
    glm::dvec3 world = kHall.min + kHall.extent() * glm::dvec3(unit(random), unit(random), unit(random));
    const unsigned on = 1 + random() % 7;  // of the three walls through the lower corner
    for (int a = 0; a < 3; ++a)
      if (on >> a & 1) world[a] = kHall.min[a];
    RayPacket rays{};
    HitPacket hits;
    glm::dvec3 directions[kPacketSize];
    for (int lane = 0; lane < kPacketSize; ++lane) {
      glm::dvec3 d(signed_unit(random), signed_unit(random), signed_unit(random));
      for (int a = 0; a < 3; ++a)
        if (on >> a & 1) d[a] = std::abs(d[a]);
      directions[lane] = glm::normalize(d);
      set_ray(rays, lane, world - origin, directions[lane], {});
    }
    rays.active = 0xffff;
    scene->intersect(rays, hits);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const WallDistance exact = exact_wall_distance(1, glm::dvec3(0), world, directions[lane]);
      worst.add(hits.part[lane] == kNoHit ? INFINITY : static_cast<double>(hits.distance[lane] - exact.distance),
                plane_distance_bound(0, world - origin, 18) / exact.cosine);
    }
  }
  return worst.in_parts_of_bound("first hits of rays that leave the surface the eye is on", "long double");
}

// A viewer there gets a plan, tiles that decode and a frame, like any other.
StressRow visits_on_surfaces(const Effort& effort) {
  const auto scene = build_scene(hall_model());
  const ImpostorSettings settings = hall_settings();
  const ImpostorSources sources = make_impostor_sources(scene, settings);
  WorstError worst;
  client::CpuWarper warper({.samples_per_pixel = 1, .threads = 1});
  const glm::dvec3 eyes[] = {{-3.25, -0.5, 2.5}, {-6, 1, -6}, {-6, -0.5, -6}, {1.5, 0.5, 1.5}, {-3.25, 2, 2.5}};
  for (const glm::dvec3& eye : eyes) {
    const Visit there = visit(scene, sources, settings, eye - scene->origin(), effort.is_full ? 200 : 24);
    client::Frame frame;
    warper.draw(there.view, {eye - scene->origin(), {1, 0, 0, 0}}, kSmallDisplay, nullptr, frame);
    for (const float disparity : frame.disparity) worst.count(!(disparity >= 0 && std::isfinite(disparity)));
    worst.count(there.needed.empty());
    if (!effort.is_full && &eye == &eyes[2]) break;
  }
  return worst.row("eyes on the floor, on a wall, in a corner, on a pillar", "a plan, and finite depths", "without", 0);
}

}  // namespace

Rows stress_borders(const Effort& effort) {
  Rows rows = cell_borders(effort);
  rows.push_back(on_surfaces(effort));
  rows.push_back(visits_on_surfaces(effort));
  return rows;
}

}  // namespace farfield::stability

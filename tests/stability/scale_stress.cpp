// SPDX-License-Identifier: Apache-2.0
// Scenes of other sizes, their finest cells scaled with them. By powers of two nothing may change, as only exponents do;
// by powers of ten each coordinate is rounded anew.
#include <fmt/format.h>

#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

struct Hall {
  std::shared_ptr<const Scene> scene;
  ImpostorSettings settings;
  ImpostorSources sources;

  explicit Hall(double scale)
      : scene(build_scene(placed(hall_model(), scaled(scale)))),
        settings(hall_settings(scale)),
        sources(make_impostor_sources(scene, settings)) {}
};

// Down to a hall of 11 micrometres, far below the 10^-3 m that are promised: at 10^-12 m the products of three lengths in
// Embree's triangle test come near the end of floats. The position grid is 2^-20 of the extent for scenes below 16 m
// (scene_frame.h): there a power of two scales all that is computed exactly.
StressRow by_powers_of_two(int exponent, const Hall& here, const Visit& visit_here, std::size_t tiles) {
  const double scale = std::ldexp(1.0, exponent);
  const Hall there(scale);
  WorstError worst;
  worst.count(here.scene->origin() * scale != there.scene->origin());
  const Visit visit_there = visit(there.scene, there.sources, there.settings, kHallEyes[0] * scale - there.scene->origin(), tiles);
  worst.count(differences(visit_here, visit_there), compared(visit_here));
  return worst.row(fmt::format("scaled by 2^{}", exponent), "the scene as it was", "leaves, tile lists, tiles, pixels that differ", 0);
}

// The level of the leaf at a viewpoint. Its index may differ: the scene's origin is rounded to the scene's own unit.
StressRow leaf_levels(int exponent, const Hall& here) {
  const double scale = std::pow(10.0, exponent);
  const Hall there(scale);
  WorstError worst;
  for (const glm::dvec3& eye : kHallEyes) {
    const CellId a = here.sources.leaves->leaf_at(eye - here.scene->origin(), nullptr).value();
    const CellId b = there.sources.leaves->leaf_at(scale * eye - there.scene->origin(), nullptr).value();
    worst.count(a.level != b.level);
  }
  return worst.row(fmt::format("levels of leaves, scaled by 10^{}", exponent), "the scene as it was", "that differ", 0);
}

}  // namespace

Rows stress_scale(const Effort& effort) {
  Rows rows;
  const Hall here(1);
  const std::size_t tiles = effort.is_full ? 40 : 4;
  const Visit visit_here = visit(here.scene, here.sources, here.settings, kHallEyes[0] - here.scene->origin(), tiles);
  for (const int exponent : {-1, -4, -10, -20}) rows.push_back(by_powers_of_two(exponent, here, visit_here, tiles));
  for (int exponent = -3; exponent <= 5; ++exponent) {
    rows.push_back(hits_in_a_room(std::pow(10.0, exponent), glm::dvec3(0), effort.is_full ? 20000 : 1000)
                       .in_parts_of_bound(fmt::format("first hits in a room of 12·10^{} m", exponent), "long double"));
  }
  for (int exponent = -3; exponent <= 5; ++exponent) rows.push_back(leaf_levels(exponent, here));
  return rows;
}

}  // namespace farfield::stability

// SPDX-License-Identifier: Apache-2.0
// Where the scene frame's zero lies in the world, and the grid its positions are rounded to.
//
// Origin: the minimum corner rounded down to a multiple of g, the power of two nearest below extent/1024, at most 1 m.
// A model moved by any multiple of g (10⁷ m, say) moves its origin by exactly as much, so everything in scene frame
// stays bit-equal.
//
// Grid: all vertices of all chunks are multiples of one power-of-two step, so that neighbouring chunks agree at their
// borders without a crack, and a chunk's positions are small integers. With E = the extent rounded up to a power of
// two, step = max(2⁻²³·E, min(2⁻¹⁶ m, 2⁻²⁰·E)): never finer than floats are at the far end, 15 µm where that is at
// least a millionth of the extent.
#pragma once

#include <glm/glm.hpp>

#include "common/math/box.h"

namespace farfield {

struct SceneFrame {
  glm::dvec3 origin{0};  // world position, multiple of g
  double step_m = 1;     // of the position grid, a power of two
};

SceneFrame choose_scene_frame(const Box& world_bounds);

/// The same rule for a mesh stored in its own axes (instances), whatever its unit: 2⁻²¹ of its extent.
double mesh_step(const Box& mesh_bounds);

}  // namespace farfield

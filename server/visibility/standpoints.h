// SPDX-License-Identifier: Apache-2.0
// Which points of a box a viewer can stand at: free space, not the inside of walls or the ground.
#pragma once

#include <vector>

#include "server/scene/scene.h"

namespace farfield {

struct Standpoints {
  std::vector<glm::dvec3> points;  // never empty; scene frame
  bool all_blocked = false;        // no free point was found: the points are the whole lattice
};

/// Tries a 3×3×3 lattice reaching to the box's corners (drawn in by 1/64 of the side, so that a viewer on the border is
/// spoken for without starting on a wall that lies in the border). A point is taken as enclosed if most of the solid angle of
/// what it sees shows back faces, where the point's surroundings are closed enough for the question to have an answer.
/// Deterministic. About 27 × 384 rays.
Standpoints find_standpoints(const Scene& scene, const Box& box);

/// The same test for one point.
bool is_free(const Scene& scene, const glm::dvec3& point);

}  // namespace farfield

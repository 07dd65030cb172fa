// SPDX-License-Identifier: Apache-2.0
// Finds a long smooth curve through free space: a chain of arcs by depth-first search with backtracking.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "server/model/random_stream.h"

namespace farfield {

/// What a path may pass through. Positions are body centres or floor points, scene frame, as its maker likes.
struct FreeSpace {
  /// The place a body that wants to be at `wanted`, coming from `before`, really takes (on the floor); nothing if it
  /// is not free.
  std::function<std::optional<glm::dvec3>(const glm::dvec3& before, const glm::dvec3& wanted)> settle;
  /// Free metres ahead, at most `reach_m`.
  std::function<double(const glm::dvec3& from, const glm::dvec3& direction, double reach_m)> openness;
};

struct PathSearchOptions {
  double length_m = 10;          // of the path wanted
  double arc_m = 0.64;           // one decision
  double step_m = 0.08;          // between checked places on an arc
  double tightest_radius_m = 0.4;
  double easy_radius_m = 1.0;
  double lookahead_m = 12;
  bool climbs = false;           // arcs may also rise and sink
};

/// Returns: places step_m apart, at least length_m of them, from `start`, first direction of the given yaw (0 looks
/// along -Z, turning left). Errors: kNotFound when the search is exhausted.
Result<std::vector<glm::dvec3>> search_path(const FreeSpace& space, const glm::dvec3& start, double start_yaw_rad,
                                            const PathSearchOptions& options, RandomStream random);

}  // namespace farfield

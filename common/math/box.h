// SPDX-License-Identifier: Apache-2.0
// Axis-aligned boxes in double precision. Boxes are half-open [min, max) where the nested shells use them.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>

namespace farfield {

struct Box {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  bool is_empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  glm::dvec3 center() const { return 0.5 * (min + max); }
  glm::dvec3 extent() const { return is_empty() ? glm::dvec3(0) : max - min; }
  void include(const glm::dvec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  void include(const Box& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  Box grown(double margin) const { return {min - margin, max + margin}; }
  /// Half-open: a point on a lower face is inside, one on an upper face is not.
  bool contains(const glm::dvec3& p) const {
    return p.x >= min.x && p.y >= min.y && p.z >= min.z && p.x < max.x && p.y < max.y && p.z < max.z;
  }
  bool contains(const Box& b) const {
    return b.min.x >= min.x && b.min.y >= min.y && b.min.z >= min.z && b.max.x <= max.x && b.max.y <= max.y &&
           b.max.z <= max.z;
  }
  /// Closed: boxes that share only a face do intersect.
  bool intersects(const Box& b) const {
    return min.x <= b.max.x && max.x >= b.min.x && min.y <= b.max.y && max.y >= b.min.y && min.z <= b.max.z &&
           max.z >= b.min.z;
  }
};

/// Where a ray from inside a box leaves it, as the ray parameter. Requires: `origin` inside or on the box.
/// Zero direction components never limit the result; a zero direction gives infinity.
inline double exit_distance(const Box& box, const glm::dvec3& origin, const glm::dvec3& direction) {
  double t = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    if (direction[a] > 0) t = std::min(t, (box.max[a] - origin[a]) / direction[a]);
    if (direction[a] < 0) t = std::min(t, (box.min[a] - origin[a]) / direction[a]);
  }
  return std::max(t, 0.0);
}

}  // namespace farfield

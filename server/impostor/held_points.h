// SPDX-License-Identifier: Apache-2.0
// Which of many surface points a view holds: sees through its shell, as deep as the warp can tell.
#pragma once

#include <cstdint>
#include <vector>

#include "server/impostor/cell_space.h"

namespace farfield {

/// How far apart points that follow each other are: next to each other in a view, or a degree and more.
enum class PointSpacing : std::uint8_t { kDense, kSparse };

/// Keeps, in order, the points that `view` does not see and those it is not asked about: `is_passed_over(point)`. Calls
/// on_held(point) for the others. Point has a member `point`, scene frame; `slack` as of set_segment(). However few are
/// asked about, rays go in full packets: neighbours first, so that a packet stays narrow.
template <class Point, class PassOver, class Held>
void drop_held(const Scene& scene, const CellSpace& space, double slack, PointSpacing spacing, const glm::dvec3& view,
               std::vector<Point>& points, PassOver is_passed_over, Held on_held) {
  std::size_t kept = 0, next = 0;
  while (next < points.size()) {
    RayPacket rays;
    rays.active = 0;
    std::size_t asked[kPacketSize];
    int lanes = 0;
    const std::size_t first = next;
    for (; next < points.size() && lanes < kPacketSize; ++next) {
      if (is_passed_over(points[next])) continue;
      asked[lanes] = next;
      rays.active |= 1u << lanes;
      set_segment(rays, lanes++, view, glm::dvec3(points[next].point), space, slack);
    }
    std::uint32_t held = 0;
    if (lanes > 0) held = rays.active & ~(spacing == PointSpacing::kDense ? scene.occluded_coherent(rays) : scene.occluded(rays));
    for (std::size_t at = first, lane = 0; at < next; ++at) {
      const bool is_asked = lane < static_cast<std::size_t>(lanes) && asked[lane] == at;
      if (is_asked && (held >> lane++ & 1)) {
        on_held(points[at]);
      } else {
        points[kept++] = points[at];
      }
    }
  }
  points.resize(kept);
}

/// The same where every point is asked about.
template <class Point, class Held>
void drop_held(const Scene& scene, const CellSpace& space, double slack, PointSpacing spacing, const glm::dvec3& view,
               std::vector<Point>& points, Held on_held) {
  drop_held(scene, space, slack, spacing, view, points, [](const Point&) { return false; }, on_held);
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/app/bake_places.h"

#include <cmath>
#include <unordered_set>

namespace farfield {

std::vector<glm::dvec3> places_along(std::span<const Trace> traces, const glm::dvec3& world_origin, const CellGrid& grid) {
  std::vector<glm::dvec3> places;
  std::unordered_set<CellId> seen;
  for (const Trace& trace : traces) {
    for (std::size_t i = 0; i < trace.frames.size(); ++i) {
      const glm::dvec3 to = trace.frames[i].pose.position - world_origin;
      const glm::dvec3 from = i == 0 ? to : trace.frames[i - 1].pose.position - world_origin;
      const int steps = static_cast<int>(std::ceil(4 * glm::length(to - from) / grid.finest_side_m)) + 1;
      for (int step = 1; step <= steps; ++step) {
        const glm::dvec3 viewpoint = glm::mix(from, to, static_cast<double>(step) / steps);
        if (seen.insert(grid.cell_at(viewpoint, 0)).second) places.push_back(viewpoint);
      }
    }
  }
  return places;
}

PlacesInBox::PlacesInBox(const Box& box, const CellGrid& grid) : grid_(grid), first_(grid.cell_at(box.min, 0)) {
  const CellId last = grid.cell_at(box.max, 0);
  count_[0] = static_cast<std::uint64_t>(last.x - first_.x + 1);
  count_[1] = static_cast<std::uint64_t>(last.y - first_.y + 1);
  count_[2] = static_cast<std::uint64_t>(last.z - first_.z + 1);
}

glm::dvec3 PlacesInBox::place(std::uint64_t index) const {
  CellId cell = first_;
  cell.x += static_cast<std::int32_t>(index % count_[0]);
  cell.z += static_cast<std::int32_t>(index / count_[0] % count_[2]);
  cell.y += static_cast<std::int32_t>(index / count_[0] / count_[2]);
  return grid_.box(cell).center();
}

}  // namespace farfield

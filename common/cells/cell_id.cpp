// SPDX-License-Identifier: Apache-2.0
#include "common/cells/cell_id.h"

#include <algorithm>
#include <cmath>

namespace farfield {

CellId CellGrid::cell_at(const glm::dvec3& point, int level) const {
  const auto index = [&](double coordinate) {
    // Division by a power of two is exact, so a point on a border falls to the upper cell, as half-open boxes want.
    const double finest = std::floor(coordinate / finest_side_m) + static_cast<double>(kGridOffset);
    const double clamped = std::clamp(finest, 0.0, static_cast<double>((std::int64_t{1} << 30) - 1));
    return static_cast<std::int32_t>(static_cast<std::int64_t>(clamped) >> level);
  };
  return {static_cast<std::uint8_t>(level), index(point.x), index(point.y), index(point.z)};
}

CellId CellGrid::enclosing(const Box& box, int level) const {
  CellId id = cell_at(box.min, level);
  while (id.level < kMaxCellLevel && !this->box(id).contains(box)) id = id.parent();
  return id;
}

}  // namespace farfield

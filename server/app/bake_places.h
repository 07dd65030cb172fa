// SPDX-License-Identifier: Apache-2.0
// Where cells are baked: the viewpoints of a camera path or of a box, one after the other, without repeating a cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/cells/cell_id.h"
#include "common/math/box.h"
#include "common/trace/trace.h"

namespace farfield {

/// One viewpoint (scene frame, metres) in each finest cell that the paths touch, in their order. Between frames paths are straight, and sampled at a quarter of
/// a finest side, so that no more than a corner is missed. O(length / side).
std::vector<glm::dvec3> places_along(std::span<const Trace> traces, const glm::dvec3& world_origin, const CellGrid& grid);

/// The finest cells that meet a box, their middles, in the order of a sweep from below: counted, not listed, for there may be millions.
class PlacesInBox {
 public:
  /// `box`: scene frame, not empty.
  PlacesInBox(const Box& box, const CellGrid& grid);
  std::uint64_t count() const { return count_[0] * count_[1] * count_[2]; }
  /// Requires: index < count().
  glm::dvec3 place(std::uint64_t index) const;

 private:
  CellGrid grid_;
  CellId first_;
  std::uint64_t count_[3] = {0, 0, 0};
};

}  // namespace farfield

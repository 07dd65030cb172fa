// SPDX-License-Identifier: Apache-2.0
// Finds the boxes that meet a box: a bounding-volume hierarchy without pointers.
//
// Boxes are put in Morton order of their centres; every eight neighbours get a common box, and so on up to one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/box.h"

namespace farfield {

class ChunkIndex {
 public:
  ChunkIndex() = default;
  /// Cost: O(n log n). Empty boxes are never found.
  explicit ChunkIndex(std::span<const Box> boxes);
  /// Indices of all boxes that meet `box` (closed: touching counts), ascending. O(log n + result).
  std::vector<std::uint32_t> find(const Box& box) const;

 private:
  std::vector<std::uint32_t> order_;  // Morton rank → index given to the constructor
  std::vector<std::vector<Box>>
      levels_;  // levels_[0][rank] are the boxes, levels_[k+1][i] covers levels_[k][8i … 8i+7]
};

}  // namespace farfield

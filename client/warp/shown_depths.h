// SPDX-License-Identifier: Apache-2.0
// The farthest thing shown in each cell of 8×8 pixels, so that what lies behind is recognised without asking every pixel.
//
// While splats are drawn pixels only come nearer: a depth found earlier stays a bound, and is only found anew where
// something was drawn since and the old one does not do.
//
// Based on: Greene, Kass & Miller 1993 (hierarchical visibility). Differs: one level above the pixels, kept lazily; where it
// cannot tell, the pixels are asked.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "client/warp/hidden_pixels.h"
#include "client/warp/project_row.h"

namespace farfield::client {

class ShownDepths {
 public:
  /// `keys`: the whole frame's; only rows of `window` are read. They may change afterwards, as drawn() is told.
  ShownDepths(const PixelWindow& window, const std::uint64_t* keys)
      : window_(window), keys_(keys), columns_((window.width + kEdge - 1) / kEdge),
        cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>((window.bottom - window.top + kEdge - 1) / kEdge)) {}

  /// Whether all of the pixels show something nearer than `nearest`, see are_hidden(). Requires: they lie in the window.
  bool hide(const PixelRectangle& pixels, float nearest) {
    const std::uint32_t bound = largest_high(nearest);
    const int first_column = pixels.left / kEdge, last_column = pixels.right / kEdge, last_row = (pixels.bottom - window_.top) / kEdge;
    for (int row = (pixels.top - window_.top) / kEdge; row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; column += kCells) {
        const int count = std::min(last_column + 1 - column, kCells);
        for (std::uint32_t open = not_above(&cells_[index(column, row)], count, bound); open != 0; open &= open - 1)
          if (!hides(pixels, bound, column + std::countr_zero(open), row)) return false;
      }
    }
    return true;
  }

  /// Something was drawn there.
  void drawn(const PixelRectangle& pixels) {
    const int last_row = (pixels.bottom - window_.top) / kEdge, last_column = pixels.right / kEdge;
    for (int row = (pixels.top - window_.top) / kEdge; row <= last_row; ++row) {
      for (int column = pixels.left / kEdge; column <= last_column; ++column) cells_[index(column, row)] &= ~kIsCurrent;
    }
  }

 private:
  static constexpr int kEdge = 8;
  static constexpr std::uint32_t kIsCurrent = 1;

  std::size_t index(int column, int row) const { return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column); }

  /// What the cell's number does not tell: the pixels are asked, and where they hide, the number is found anew.
  bool hides(const PixelRectangle& pixels, std::uint32_t bound, int column, int row);

  PixelWindow window_;
  const std::uint64_t* keys_;
  int columns_;
  /// The upper half of the smallest key of each cell, or less, and kIsCurrent instead of its lowest bit, which says nothing: where
  /// it is not set the smallest may be larger by now.
  std::vector<std::uint32_t> cells_;
};

}  // namespace farfield::client

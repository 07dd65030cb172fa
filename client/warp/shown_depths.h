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
    const std::uint64_t bound = largest_key(nearest);
    const int last_row = (pixels.bottom - window_.top) / kEdge, last_column = pixels.right / kEdge;
    for (int row = (pixels.top - window_.top) / kEdge; row <= last_row; ++row) {
      for (int column = pixels.left / kEdge; column <= last_column; ++column) {
        Cell& cell = cells_[index(column, row)];
        if (cell.farthest < bound && !hides(pixels, bound, column, row, cell)) return false;
      }
    }
    return true;
  }

  /// Something was drawn there.
  void drawn(const PixelRectangle& pixels) {
    const int last_row = (pixels.bottom - window_.top) / kEdge, last_column = pixels.right / kEdge;
    for (int row = (pixels.top - window_.top) / kEdge; row <= last_row; ++row) {
      for (int column = pixels.left / kEdge; column <= last_column; ++column) cells_[index(column, row)].is_old = true;
    }
  }

 private:
  static constexpr int kEdge = 8;
  struct Cell {
    std::uint64_t farthest = kNoSplat;  // no key of the cell is smaller
    bool is_old = true;                 // the smallest may be larger by now
  };

  std::size_t index(int column, int row) const { return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column); }

  bool hides(const PixelRectangle& pixels, std::uint64_t bound, int column, int row, Cell& cell) const {
    const int left = column * kEdge, top = window_.top + row * kEdge;
    const PixelRectangle whole{left, std::min(left + kEdge, window_.width) - 1, top, std::min(top + kEdge, window_.bottom) - 1};
    if (cell.is_old) {
      cell.farthest = smallest_key(whole, window_.width, keys_);
      cell.is_old = false;
      if (cell.farthest >= bound) return true;
    }
    const PixelRectangle part{std::max(whole.left, pixels.left), std::min(whole.right, pixels.right),
                              std::max(whole.top, pixels.top), std::min(whole.bottom, pixels.bottom)};
    return !any_smaller_in(part, bound, window_.width, keys_);
  }

  PixelWindow window_;
  const std::uint64_t* keys_;
  int columns_;
  std::vector<Cell> cells_;
};

}  // namespace farfield::client

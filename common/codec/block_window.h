// SPDX-License-Identifier: Apache-2.0
// One value per sample of a block that is being coded, with those around it that are coded already.
//
// Layout: 12 columns × 12 rows of bytes; sample (x, y) of the block at (x + 2, y + 2). Around it two columns of the block
// to the left, two rows of the block above, and of the blocks beside that one, as far as they come earlier in the order of
// blocks (in packed tiles, which go by column, the one above to the right never does). All else is 0.
#pragma once

#include <array>
#include <cstdint>

#include "common/codec/tile_bits.h"

namespace farfield {

class BlockWindow {
 public:
  /// `value(block, k)`: of sample k of an earlier block.
  template <class Value>
  BlockWindow(const BlockGrid& grid, int block, Value value) {
    const auto known = [&](int other) { return other < block ? other : -1; };
    const int left = known(grid.beside(block).left), above = known(grid.beside(block).above);
    const auto copy = [&](int from, int x0, int y0, int x1, int y1, int to) {
      if (from < 0) return;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) values_[to + (y - y0) * kColumns + (x - x0)] = value(from, y * kBlockSamples + x);
    };
    copy(left, 6, 0, 8, 8, 2 * kColumns);
    copy(above, 0, 6, 8, 8, 2);
    if (above < 0) return;
    copy(known(grid.beside(above).left), 6, 6, 8, 8, 0);
    copy(known(grid.beside(above).right), 0, 6, 2, 8, 2 + kBlockSamples);
  }

  /// Of the sample `dx` columns and `dy` rows from sample k; both -2 … 2, not further down than what is known.
  std::uint8_t at(int k, int dx, int dy) const { return values_[place_of(k) + dy * kColumns + dx]; }
  void set(int k, std::uint8_t value) { values_[place_of(k)] = value; }

 private:
  static constexpr int kColumns = 2 + kBlockSamples + 2, kRows = 2 + kBlockSamples + 2;
  static int place_of(int k) { return (k / kBlockSamples + 2) * kColumns + k % kBlockSamples + 2; }
  std::array<std::uint8_t, kColumns * kRows> values_{};
};

}  // namespace farfield

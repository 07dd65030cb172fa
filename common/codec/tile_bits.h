// SPDX-License-Identifier: Apache-2.0
// Coverage and cuts of a tile as one bit per sample, in words of one 8×8 block: questions about 64 samples at once.
//
// Layout: bit 8·y + x of a word is sample (x, y) of the block; blocks in raster order of the image that the tile's
// arrays are, the last column and row perhaps not whole.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/tile.h"

namespace farfield {

inline constexpr std::uint64_t kFirstColumn = 0x0101010101010101u, kLastColumn = kFirstColumn << 7;
inline constexpr std::uint64_t kFirstRow = 0xff, kLastRow = kFirstRow << 56;

/// Where the blocks of a tile are, and which lie side by side on the face.
class BlockGrid {
 public:
  explicit BlockGrid(const Tile& tile);

  /// Blocks beside one on the face, -1: none. In packed tiles these need not be neighbours in the image.
  struct Beside {
    int left = -1, above = -1, right = -1, below = -1;
  };

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int size() const { return columns_ * rows_; }
  const Beside& beside(int block) const { return beside_[block]; }
  /// Index of a block's first sample in the tile's arrays.
  int first_sample(int block) const { return block / columns_ * kBlockSamples * width_ + block % columns_ * kBlockSamples; }
  /// Samples that the image has: all of them but in the last column and row.
  std::uint64_t samples(int block) const;
  /// Of these, the ones that have a neighbour to the right, or below.
  std::uint64_t with_right(int block) const;
  std::uint64_t with_below(int block) const;

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_, height_, columns_, rows_;
  std::vector<Beside> beside_;
};

/// The bits of the samples to the right (below), from a block's own word and the word of the block there (0: none).
inline std::uint64_t bits_to_the_right(std::uint64_t own, std::uint64_t right) {
  return (own >> 1 & ~kLastColumn) | (right & kFirstColumn) << 7;
}
inline std::uint64_t bits_below(std::uint64_t own, std::uint64_t below) { return own >> 8 | below << 56; }

struct BlockBits {
  std::uint64_t covered = 0;
  std::uint64_t cut_right = 0, cut_down = 0;  // whatever the ends are
};

class TileBits {
 public:
  /// Requires: arrays of the tile's size. O(samples).
  explicit TileBits(const Tile& tile);

  const BlockGrid& grid() const { return grid_; }
  const BlockBits& operator[](int block) const { return blocks_[block]; }
  /// Samples that are one surface with their right (lower) neighbour.
  std::uint64_t joined_right(int block) const;
  std::uint64_t joined_below(int block) const;

 private:
  std::uint64_t covered_in(int block) const { return block < 0 ? 0 : blocks_[block].covered; }

  BlockGrid grid_;
  std::vector<BlockBits> blocks_;
};

}  // namespace farfield

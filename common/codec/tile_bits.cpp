// SPDX-License-Identifier: Apache-2.0
#include "common/codec/tile_bits.h"

#include <algorithm>
#include <cstring>

#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

// Which of eight bytes are not zero, the first in the lowest bit.
std::uint64_t non_zero(std::uint64_t bytes) {
  constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7fu;
  const std::uint64_t high = ((bytes & kLow) + kLow) | bytes;
  return (high >> 7 & kFirstColumn) * 0x0102040810204080u >> 56;
}

std::uint64_t bits_of(const std::uint8_t* first, int width, int columns, int rows) {
  std::uint64_t bits = 0;
  for (int y = 0; y < rows; ++y) {
    std::uint64_t bytes = 0;
    if (columns == kBlockSamples) {
      std::memcpy(&bytes, first + static_cast<std::size_t>(y) * width, kBlockSamples);
    } else {
      std::memcpy(&bytes, first + static_cast<std::size_t>(y) * width, static_cast<std::size_t>(columns));
    }
    bits |= non_zero(bytes) << 8 * y;
  }
  return bits;
}

}  // namespace

BlockGrid::BlockGrid(const Tile& tile)
    : width_(tile.width), height_(tile.height), columns_((tile.width + kBlockSamples - 1) / kBlockSamples),
      rows_((tile.height + kBlockSamples - 1) / kBlockSamples), beside_(static_cast<std::size_t>(columns_) * rows_) {
  const TileNeighbours neighbours(tile);
  const auto block_of = [&](int sample) { return sample / width_ / kBlockSamples * columns_ + sample % width_ / kBlockSamples; };
  for (int block = 0; block < size(); ++block) {
    const int left = neighbours.left(first_sample(block)), above = neighbours.up(first_sample(block));
    if (left >= 0) beside_[beside_[block].left = block_of(left)].right = block;
    if (above >= 0) beside_[beside_[block].above = block_of(above)].below = block;
  }
}

std::uint64_t BlockGrid::samples(int block) const {
  const int x = std::min(kBlockSamples, width_ - block % columns_ * kBlockSamples);
  const int y = std::min(kBlockSamples, height_ - block / columns_ * kBlockSamples);
  return (0xffu >> (kBlockSamples - x)) * kFirstColumn & ~std::uint64_t{0} >> 8 * (kBlockSamples - y);
}

std::uint64_t BlockGrid::with_right(int block) const {
  const int right = beside_[block].right;
  const std::uint64_t own = samples(block);
  return own & bits_to_the_right(own, right < 0 ? 0 : samples(right));
}
std::uint64_t BlockGrid::with_below(int block) const {
  const int below = beside_[block].below;
  const std::uint64_t own = samples(block);
  return own & bits_below(own, below < 0 ? 0 : samples(below));
}

TileBits::TileBits(const Tile& tile) : grid_(tile), blocks_(static_cast<std::size_t>(grid_.size())) {
  for (int block = 0; block < grid_.size(); ++block) {
    const int first = grid_.first_sample(block);
    const int columns = std::min(kBlockSamples, tile.width - block % grid_.columns() * kBlockSamples);
    const int rows = std::min(kBlockSamples, tile.height - block / grid_.columns() * kBlockSamples);
    const auto bits = [&](const std::vector<std::uint8_t>& values) { return bits_of(&values[first], tile.width, columns, rows); };
    blocks_[block].covered = bits(tile.coverage);
    if (blocks_[block].covered == 0) continue;  // no cut of an uncovered sample counts as a join
    blocks_[block].cut_right = bits(tile.cut_right), blocks_[block].cut_down = bits(tile.cut_down);
  }
}

std::uint64_t TileBits::joined_right(int block) const {
  const BlockBits& own = blocks_[block];
  return own.covered & ~own.cut_right & bits_to_the_right(own.covered, covered_in(grid_.beside(block).right));
}
std::uint64_t TileBits::joined_below(int block) const {
  const BlockBits& own = blocks_[block];
  return own.covered & ~own.cut_down & bits_below(own.covered, covered_in(grid_.beside(block).below));
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Based on: fills of bit boards along their rows (Kogge & Stone 1973, parallel prefix).
#include "common/codec/plane_nodes.h"

namespace farfield {
namespace {

// The quarter of a block that a node of half a block's size is.
std::uint64_t quarter_of(const Node& node) {
  return std::uint64_t{0x0f0f0f0f} << (node.x % kBlockSamples) << 8 * (node.y % kBlockSamples);
}
int block_of(const TileBits& bits, int x, int y) { return y / kBlockSamples * bits.grid().columns() + x / kBlockSamples; }

// Everything in a row that joins lead to from `samples`. Bit x of `joined`: x and x + 1 belong together.
std::uint32_t spread(std::uint32_t samples, std::uint32_t joined) {
  std::uint32_t from_left = joined << 1, from_right = joined;
  for (int step = 1; step < kLargestNode; step *= 2) {
    samples |= (samples << step & from_left) | (samples >> step & from_right);
    from_left &= from_left << step, from_right &= from_right >> step;
  }
  return samples;
}

}  // namespace

bool is_empty(const TileBits& bits, const Node& node) {
  if (node.size < kBlockSamples) return (bits[block_of(bits, node.x, node.y)].covered & quarter_of(node)) == 0;
  for (int y = node.y; y < node.y + node.size; y += kBlockSamples)
    for (int x = node.x; x < node.x + node.size; x += kBlockSamples)
      if (bits[block_of(bits, x, y)].covered != 0) return false;
  return true;
}

bool is_whole(const TileBits& bits, const Node& node) {
  const int x_end = node.x + node.size, y_end = node.y + node.size;
  for (int y = node.y; y < y_end; y += kBlockSamples)
    for (int x = node.x; x < x_end; x += kBlockSamples) {
      const BlockBits& block = bits[block_of(bits, x, y)];
      const std::uint64_t inside = node.size < kBlockSamples ? quarter_of(node) : ~std::uint64_t{0};
      if ((~block.covered & inside) != 0) return false;
      // The last column and row of the node have their edges across its border.
      const std::uint64_t right = x + kBlockSamples < x_end ? inside : inside & inside >> 1 & ~kLastColumn;
      const std::uint64_t down = y + kBlockSamples < y_end ? inside : inside & inside >> 8;
      if ((block.cut_right & right) != 0 || (block.cut_down & down) != 0) return false;
    }
  return true;
}

NodeSurfaces::NodeSurfaces(const TileBits& bits, const Node& node) : size_(node.size) {
  const int at = node.x % kBlockSamples;  // of a node smaller than a block
  const std::uint32_t mask = 0xffffffffu >> (kLargestNode - size_);
  for (int y = 0; y < size_; ++y) {
    std::uint32_t cut_right = 0, cut_down = 0;
    const int shift = (node.y + y) % kBlockSamples * 8;
    for (int x = 0; x < size_; x += kBlockSamples) {
      const BlockBits& block = bits[block_of(bits, node.x + x, node.y + y)];
      const auto row = [&](std::uint64_t word) { return static_cast<std::uint32_t>(word >> shift & 0xff) >> at << x; };
      left_[y] |= row(block.covered);
      cut_right |= row(block.cut_right), cut_down |= row(block.cut_down);
    }
    left_[y] &= mask;
    joined_right_[y] = left_[y] & left_[y] >> 1 & ~cut_right;
    joined_below_[y] = left_[y] & ~cut_down;
    if (y > 0) joined_below_[y - 1] &= left_[y];
  }
  joined_below_[size_ - 1] = 0;
}

bool NodeSurfaces::next(NodeSamples& surface) {
  while (row_ < size_ && left_[row_] == 0) ++row_;
  if (row_ == size_) return false;
  surface.rows.fill(0);
  surface.first_row = row_, surface.end_row = row_ + 1;
  surface.rows[row_] = spread(left_[row_] & (0u - left_[row_]), joined_right_[row_]);
  for (bool is_growing = true; is_growing;) {
    is_growing = false;
    const auto grow = [&](int y, std::uint32_t samples) {
      if ((samples & ~surface.rows[y]) == 0) return;
      surface.rows[y] = spread(surface.rows[y] | samples, joined_right_[y]);
      is_growing = true;
    };
    for (int y = row_ + 1; y < size_; ++y) {
      grow(y, surface.rows[y - 1] & joined_below_[y - 1]);
      if (y >= surface.end_row) {
        if (surface.rows[y] == 0) break;
        surface.end_row = y + 1;
      }
    }
    for (int y = surface.end_row - 2; y >= row_; --y) grow(y, surface.rows[y + 1] & joined_below_[y]);
  }
  for (int y = surface.first_row; y < surface.end_row; ++y) left_[y] &= ~surface.rows[y];
  return true;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/tile_neighbours.h"

#include <algorithm>

namespace farfield {

TileNeighbours::TileNeighbours(bool is_packed, int width, int height, const std::vector<BlockPlace>& blocks)
    : is_packed_(is_packed), width_(width), size_(width * height) {
  if (!is_packed || blocks.empty()) return;
  places_ = blocks;
  int max_x = blocks[0].x, max_y = blocks[0].y;
  min_x_ = max_x, min_y_ = max_y;
  for (const BlockPlace& b : blocks) {
    min_x_ = std::min<int>(min_x_, b.x), max_x = std::max<int>(max_x, b.x);
    min_y_ = std::min<int>(min_y_, b.y), max_y = std::max<int>(max_y, b.y);
  }
  columns_ = max_x - min_x_ + 1, rows_ = max_y - min_y_ + 1;
  block_at_.assign(static_cast<std::size_t>(columns_) * rows_, -1);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    block_at_[static_cast<std::size_t>(blocks[i].y - min_y_) * columns_ + (blocks[i].x - min_x_)] = static_cast<int>(i);
}

int TileNeighbours::across(int index, int dx, int dy) const {
  const int column = column_of(index), row = row_of(index);
  const int x = column % kBlockSamples + dx, y = row % kBlockSamples + dy;
  if (x >= 0 && y >= 0 && x < kBlockSamples && y < kBlockSamples) return index + dy * width_ + dx;
  const std::size_t block = static_cast<std::size_t>(row / kBlockSamples) * kPackedColumns + column / kBlockSamples;
  if (block >= places_.size()) return -1;
  const int block_x = places_[block].x - min_x_ + dx, block_y = places_[block].y - min_y_ + dy;
  if (block_x < 0 || block_y < 0 || block_x >= columns_ || block_y >= rows_) return -1;
  const int other = block_at_[static_cast<std::size_t>(block_y) * columns_ + block_x];
  if (other < 0) return -1;
  const int other_column = other % kPackedColumns * kBlockSamples + (x + kBlockSamples) % kBlockSamples;
  const int other_row = other / kPackedColumns * kBlockSamples + (y + kBlockSamples) % kBlockSamples;
  return other_row * width_ + other_column;
}

}  // namespace farfield

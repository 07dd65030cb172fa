// SPDX-License-Identifier: Apache-2.0
// Which sample of a tile lies right of and below another on the face: trivial in dense tiles, across the block map in
// packed ones.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/tile.h"

namespace farfield {

/// Size of the image that holds `blocks` packed blocks.
inline int packed_width(std::size_t blocks) {
  return static_cast<int>(blocks < kPackedColumns ? blocks : kPackedColumns) * kBlockSamples;
}
inline int packed_height(std::size_t blocks) {
  return static_cast<int>((blocks + kPackedColumns - 1) / kPackedColumns) * kBlockSamples;
}

/// Index of a neighbour in the tile's arrays, or -1. Copies nothing of the tile but its block map.
class TileNeighbours {
 public:
  explicit TileNeighbours(const Tile& tile) : TileNeighbours(tile.is_packed(), tile.width, tile.height, tile.blocks) {}
  TileNeighbours(bool is_packed, int width, int height, const std::vector<BlockPlace>& blocks);

  int right(int index) const { return is_packed_ ? across(index, 1, 0) : (column_of(index) + 1 < width_ ? index + 1 : -1); }
  int down(int index) const { return is_packed_ ? across(index, 0, 1) : (index + width_ < size_ ? index + width_ : -1); }
  int left(int index) const { return is_packed_ ? across(index, -1, 0) : (column_of(index) > 0 ? index - 1 : -1); }
  int up(int index) const { return is_packed_ ? across(index, 0, -1) : (index >= width_ ? index - width_ : -1); }

 private:
  // Nearly every tile has the one width that a compiler can divide by quickly.
  int column_of(int index) const { return width_ == kTileSamples ? index % kTileSamples : index % width_; }
  int row_of(int index) const { return width_ == kTileSamples ? index / kTileSamples : index / width_; }
  int across(int index, int dx, int dy) const;

  bool is_packed_;
  int width_, size_;
  int min_x_ = 0, min_y_ = 0, columns_ = 0, rows_ = 0;
  std::vector<BlockPlace> places_;
  std::vector<std::int32_t> block_at_;  // [row][column] of the blocks' bounding rectangle, -1: none
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Which samples of a dense tile it draws itself. Of the two rows and columns that it shares with each neighbour a tile draws
// the inner one, so that it knows the neighbours of all it draws. At the ends of a face there is no other tile.
#pragma once

#include <algorithm>

#include "common/impostor/tile.h"

namespace farfield {

/// Columns [first_column, end_column) × rows [first_row, end_row) of the tile's arrays.
struct DrawnSamples {
  int first_column = 0, end_column = 0, first_row = 0, end_row = 0;

  explicit DrawnSamples(const Tile& dense) {
    const int tiles = face_tiles(dense.edge_samples);
    const auto end = [&](int place, int size) { return place + 1 < tiles ? std::min(size, kTileStride + 1) : size; };
    first_column = dense.id.x > 0 ? 1 : 0, end_column = end(dense.id.x, dense.width);
    first_row = dense.id.y > 0 ? 1 : 0, end_row = end(dense.id.y, dense.height);
  }
};

}  // namespace farfield

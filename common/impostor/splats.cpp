// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/splats.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/math/cube_face.h"

namespace farfield {
namespace {

/// Appends the covered samples of one row of `tile`, keeping the last run open while samples stay adjacent.
class RunWriter {
 public:
  RunWriter(const Tile& tile, Splats& splats) : tile_(tile), splats_(splats) {}

  void begin_row(std::uint32_t face_row) {
    v_ = static_cast<float>(sample_tangent(tile_.edge_samples, face_row));
    is_open_ = false;
  }

  /// `count` samples from array index `index`; the first stands at `face_column`.
  void append(std::size_t index, std::uint32_t face_column, int count) {
    for (int i = 0; i < count; ++i, ++index, ++face_column) {
      if (!tile_.coverage[index]) continue;
      if (!is_open_ || face_column != next_column_) open(face_column);
      push(index);
      ++splats_.runs.back().count;
      next_column_ = face_column + 1;
    }
  }

 private:
  void open(std::uint32_t face_column) {
    const float u0 = static_cast<float>(sample_tangent(tile_.edge_samples, face_column));
    splats_.runs.push_back({u0, v_, static_cast<std::uint32_t>(splats_.disparity.size()), 0});
    is_open_ = true;
  }
  void push(std::size_t index) {
    const std::uint8_t* rgb = &tile_.rgb[3 * index];
    splats_.disparity.push_back(tile_.disparity[index]);
    splats_.colour.push_back(rgb[0] | (static_cast<std::uint32_t>(rgb[1]) << 8) |
                             (static_cast<std::uint32_t>(rgb[2]) << 16));
  }

  const Tile& tile_;
  Splats& splats_;
  float v_ = 0;
  std::uint32_t next_column_ = 0;
  bool is_open_ = false;
};

void append_dense(const Tile& tile, Splats& splats) {
  // The tile at the far end of a face shares its last rows with nobody: there, positive faces meet each other's far
  // ends, so leaving them out would open a gap three samples wide.
  const int tiles = face_tiles(tile.edge_samples);
  const int columns = tile.id.x + 1 < tiles ? std::min(tile.width, kTileStride) : tile.width;
  const int rows = tile.id.y + 1 < tiles ? std::min(tile.height, kTileStride) : tile.height;
  const std::uint32_t first_column = static_cast<std::uint32_t>(tile.id.x) * kTileStride;
  const std::uint32_t first_row = static_cast<std::uint32_t>(tile.id.y) * kTileStride;
  RunWriter writer(tile, splats);
  for (int j = 0; j < rows; ++j) {
    writer.begin_row(first_row + j);
    writer.append(static_cast<std::size_t>(j) * tile.width, first_column, columns);
  }
}

void append_packed(const Tile& tile, Splats& splats) {
  // Blocks in rows of the face, so that runs continue from a block into its right neighbour.
  std::vector<std::uint32_t> order(tile.blocks.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const BlockPlace &p = tile.blocks[a], &q = tile.blocks[b];
    return p.y != q.y ? p.y < q.y : p.x < q.x;
  });
  RunWriter writer(tile, splats);
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const std::uint32_t block_row = tile.blocks[order[begin]].y;
    while (end < order.size() && tile.blocks[order[end]].y == block_row) ++end;
    for (int j = 0; j < kBlockSamples; ++j) {
      writer.begin_row(block_row * kBlockSamples + j);
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t b = order[k];
        const std::size_t row = static_cast<std::size_t>(b / kPackedColumns) * kBlockSamples + j;
        const std::size_t column = static_cast<std::size_t>(b % kPackedColumns) * kBlockSamples;
        writer.append(row * tile.width + column, static_cast<std::uint32_t>(tile.blocks[b].x) * kBlockSamples,
                      kBlockSamples);
      }
    }
  }
}

void find_bounds(Splats& splats) {
  if (splats.runs.empty()) return;
  const auto [low, high] = std::minmax_element(splats.disparity.begin(), splats.disparity.end());
  splats.min_disparity = *low;
  splats.max_disparity = *high;
  splats.u_min = splats.v_min = std::numeric_limits<float>::infinity();
  splats.u_max = splats.v_max = -std::numeric_limits<float>::infinity();
  for (const SplatRun& run : splats.runs) {
    splats.u_min = std::min(splats.u_min, run.u0);
    splats.u_max = std::max(splats.u_max, run.u0 + static_cast<float>(run.count - 1) * splats.pitch);
    splats.v_min = std::min(splats.v_min, run.v);
    splats.v_max = std::max(splats.v_max, run.v);
  }
}

}  // namespace

Splats build_splats(const Tile& tile) {
  Splats splats;
  splats.face = tile.id.face;
  splats.pitch = static_cast<float>(sample_pitch(tile.edge_samples));
  const std::size_t covered =
      static_cast<std::size_t>(std::count_if(tile.coverage.begin(), tile.coverage.end(), [](auto c) { return c != 0; }));
  splats.disparity.reserve(covered);
  splats.colour.reserve(covered);
  if (tile.is_packed()) {
    append_packed(tile, splats);
  } else {
    append_dense(tile, splats);
  }
  find_bounds(splats);
  return splats;
}

}  // namespace farfield

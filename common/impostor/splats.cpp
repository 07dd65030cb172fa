// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/splats.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/impostor/tile_neighbours.h"
#include "common/math/cube_face.h"

namespace farfield {
namespace {

/// Appends the covered samples of one row of `tile`, keeping the last run open while samples stay adjacent.
class RunWriter {
 public:
  RunWriter(const Tile& tile, Splats& splats) : tile_(tile), neighbours_(tile), splats_(splats) {}

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
  std::uint32_t colour(int index) const {
    const std::uint8_t* rgb = &tile_.rgb[3 * static_cast<std::size_t>(index)];
    return rgb[0] | static_cast<std::uint32_t>(rgb[1]) << 8 | static_cast<std::uint32_t>(rgb[2]) << 16;
  }
  void push(std::size_t at) {
    const int index = static_cast<int>(at);
    const Side left = side(neighbours_.left(index), tile_.cut_right, neighbours_.left(index), false);
    const Side right = side(neighbours_.right(index), tile_.cut_right, index, true);
    const Side up = side(neighbours_.up(index), tile_.cut_down, neighbours_.up(index), false);
    const Side down = side(neighbours_.down(index), tile_.cut_down, index, true);
    splats_.disparity.push_back(tile_.disparity[at]);
    splats_.slopes.push_back(pack_slopes(slope(index, left.index, right.index), slope(index, up.index, down.index)));
    splats_.colour.push_back(colour(index));
    splats_.colour_up.push_back(colour(up.index >= 0 ? up.index : index));
    splats_.colour_down.push_back(colour(down.index >= 0 ? down.index : index));
    splats_.reach.push_back(pack_reach(left.reach, right.reach, up.reach, down.reach));
  }

  struct Side {
    int index = -1;  // of the connected neighbour
    std::uint32_t reach = kReachToNothing;
  };
  /// `before`: the upper or left one of the two, which holds the cut. `is_before`: that is the sample itself.
  Side side(int neighbour, const std::vector<std::uint8_t>& cuts, int before, bool is_before) const {
    if (neighbour < 0) return {};
    const std::uint32_t cut = std::min<std::uint32_t>(cuts[before], 8);
    if (cut == kConnected) return tile_.coverage[neighbour] ? Side{neighbour, kReachConnected} : Side{};
    return {-1, is_before ? 2 * cut - 1 : 17 - 2 * cut};
  }
  /// The central difference, or towards the one neighbour there is.
  float slope(int index, int before, int after) const {
    const float span = static_cast<float>((before >= 0) + (after >= 0));
    if (before < 0 && after < 0) return 0;
    return (tile_.disparity[after >= 0 ? after : index] - tile_.disparity[before >= 0 ? before : index]) / span;
  }

  const Tile& tile_;
  const TileNeighbours neighbours_;
  Splats& splats_;
  float v_ = 0;
  std::uint32_t next_column_ = 0;
  bool is_open_ = false;
};

void append_dense(const Tile& tile, Splats& splats) {
  // Of the two rows and columns it shares with each neighbour a tile holds the inner one, so that it knows the
  // neighbours of all it holds. At the ends of a face there is no other tile.
  const int tiles = face_tiles(tile.edge_samples);
  const auto begin = [](int place) { return place > 0 ? 1 : 0; };
  const auto end = [&](int place, int size) { return place + 1 < tiles ? std::min(size, kTileStride + 1) : size; };
  const int first_column = begin(tile.id.x), columns = end(tile.id.x, tile.width) - first_column;
  const std::uint32_t face_column = static_cast<std::uint32_t>(tile.id.x) * kTileStride + first_column;
  const std::uint32_t face_row = static_cast<std::uint32_t>(tile.id.y) * kTileStride;
  RunWriter writer(tile, splats);
  for (int j = begin(tile.id.y); j < end(tile.id.y, tile.height); ++j) {
    writer.begin_row(face_row + j);
    writer.append(static_cast<std::size_t>(j) * tile.width + first_column, face_column, columns);
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

/// Connections that leave a run: the neighbour's colour is not beside the sample's.
void mark_ends(Splats& splats) {
  const auto mark = [&](std::size_t sample, int shift) {
    std::uint16_t& reach = splats.reach[sample];
    if ((reach >> shift & 15) == kReachConnected) {
      reach = static_cast<std::uint16_t>((reach & ~(15 << shift)) | kReachOutOfRun << shift);
    }
  };
  for (const SplatRun& run : splats.runs) {
    mark(run.first, 0);
    mark(run.first + run.count - 1, 4);
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
  splats.reach.reserve(covered);
  for (auto* words : {&splats.slopes, &splats.colour, &splats.colour_up, &splats.colour_down}) words->reserve(covered);
  if (tile.is_packed()) {
    append_packed(tile, splats);
  } else {
    append_dense(tile, splats);
  }
  mark_ends(splats);
  find_bounds(splats);
  return splats;
}

}  // namespace farfield

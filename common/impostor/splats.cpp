// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/splats.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/impostor/tile_neighbours.h"
#include "common/math/cube_face.h"

namespace farfield {
namespace {

/// Appends the covered samples of `tile` row by row; those to be drawn form runs, open while samples stay adjacent.
class SplatsBuilder {
 public:
  SplatsBuilder(const Tile& tile, Splats& splats)
      : tile_(tile), neighbours_(tile), splats_(splats), place_(tile.samples(), kNotHeld) {}

  void begin_row(std::uint32_t face_row) {
    v_ = static_cast<float>(sample_tangent(tile_.edge_samples, face_row));
    is_open_ = false;
  }

  /// `count` samples from array index `index`; the first stands at `face_column`. Those numbered [first_drawn, end_drawn)
  /// join runs.
  void append(std::size_t index, std::uint32_t face_column, int count, int first_drawn, int end_drawn) {
    for (int i = 0; i < count; ++i, ++index, ++face_column) {
      if (!tile_.coverage[index]) continue;
      if (i >= first_drawn && i < end_drawn) {
        if (!is_open_ || face_column != next_column_) open(face_column);
        ++splats_.runs.back().count;
        ++splats_.drawn;
        next_column_ = face_column + 1;
      }
      push(index);
    }
  }

  void finish() {
    for (std::size_t k = 0; k < index_.size(); ++k) link(k);
    splats_.runs.shrink_to_fit();
    splats_.links.shrink_to_fit();
  }

 private:
  static constexpr std::uint32_t kNotHeld = ~0u;

  void open(std::uint32_t face_column) {
    const float u0 = static_cast<float>(sample_tangent(tile_.edge_samples, face_column));
    splats_.runs.push_back({u0, v_, static_cast<std::uint32_t>(splats_.disparity.size()), 0});
    is_open_ = true;
  }
  void push(std::size_t at) {
    const int index = static_cast<int>(at);
    const std::uint8_t* rgb = &tile_.rgb[3 * at];
    place_[at] = static_cast<std::uint32_t>(index_.size());
    index_.push_back(index);
    splats_.disparity.push_back(tile_.disparity[at]);
    splats_.colour.push_back(rgb[0] | static_cast<std::uint32_t>(rgb[1]) << 8 | static_cast<std::uint32_t>(rgb[2]) << 16);
    const int left = neighbours_.left(index), up = neighbours_.up(index);
    splats_.reach.push_back(pack_reach(reach(left, tile_.cut_right, left, false),
                                       reach(neighbours_.right(index), tile_.cut_right, index, true),
                                       reach(up, tile_.cut_down, up, false),
                                       reach(neighbours_.down(index), tile_.cut_down, index, true)));
  }
  /// `before`: the upper or left one of the two, which holds the cut. `is_before`: that is the sample itself.
  std::uint32_t reach(int neighbour, const std::vector<std::uint8_t>& cuts, int before, bool is_before) const {
    if (neighbour < 0) return kReachToNothing;
    const std::uint32_t cut = std::min<std::uint32_t>(cuts[before], 8);
    if (cut == kConnected) return tile_.coverage[neighbour] ? kReachConnected : kReachToNothing;
    return is_before ? 2 * cut - 1 : 17 - 2 * cut;
  }

  /// Begins a new link where the one before does not lead to sample k's neighbours, or would lead out of the arrays.
  void link(std::size_t k) {
    const bool has_up = is_connected(k, 8, neighbours_.up(index_[k]));
    const bool has_down = is_connected(k, 12, neighbours_.down(index_[k]));
    const std::uint16_t up = has_up ? distance(place_[neighbours_.up(index_[k])], k) : 0;
    const std::uint16_t down = has_down ? distance(k, place_[neighbours_.down(index_[k])]) : 0;
    SplatLink next{static_cast<std::uint32_t>(k), up, down};
    if (!splats_.links.empty()) {
      const SplatLink& last = splats_.links.back();
      if (!has_up) next.up = last.up;
      if (!has_down) next.down = k + last.down < index_.size() ? last.down : 0;
      if (next.up == last.up && next.down == last.down) return;
    }
    splats_.links.push_back(next);
  }
  /// Takes the connection away where the neighbour is too far off in the arrays: no tile that a decoder returns has any.
  bool is_connected(std::size_t k, int shift, int neighbour) {
    if ((splats_.reach[k] >> shift & 15) != kReachConnected) return false;
    const std::size_t other = place_[neighbour];
    if ((other > k ? other - k : k - other) <= std::numeric_limits<std::uint16_t>::max()) return true;
    splats_.reach[k] = static_cast<std::uint16_t>((splats_.reach[k] & ~(15 << shift)) | kReachToNothing << shift);
    return false;
  }
  static std::uint16_t distance(std::size_t from, std::size_t to) { return static_cast<std::uint16_t>(to - from); }

  const Tile& tile_;
  const TileNeighbours neighbours_;
  Splats& splats_;
  std::vector<std::uint32_t> place_;  // by tile index: where the sample is held
  std::vector<int> index_;            // and back
  float v_ = 0;
  std::uint32_t next_column_ = 0;
  bool is_open_ = false;
};

void append_dense(const Tile& tile, SplatsBuilder& builder) {
  // Of the two rows and columns it shares with each neighbour a tile draws the inner one, so that it knows the
  // neighbours of all it draws. At the ends of a face there is no other tile.
  const int tiles = face_tiles(tile.edge_samples);
  const auto begin = [](int place) { return place > 0 ? 1 : 0; };
  const auto end = [&](int place, int size) { return place + 1 < tiles ? std::min(size, kTileStride + 1) : size; };
  const std::uint32_t face_column = static_cast<std::uint32_t>(tile.id.x) * kTileStride;
  const std::uint32_t face_row = static_cast<std::uint32_t>(tile.id.y) * kTileStride;
  for (int j = 0; j < tile.height; ++j) {
    const bool is_drawn = j >= begin(tile.id.y) && j < end(tile.id.y, tile.height);
    builder.begin_row(face_row + j);
    builder.append(static_cast<std::size_t>(j) * tile.width, face_column, tile.width, begin(tile.id.x),
                   is_drawn ? end(tile.id.x, tile.width) : 0);
  }
}

void append_packed(const Tile& tile, SplatsBuilder& builder) {
  // Blocks in rows of the face, so that runs continue from a block into its right neighbour.
  std::vector<std::uint32_t> order(tile.blocks.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const BlockPlace &p = tile.blocks[a], &q = tile.blocks[b];
    return p.y != q.y ? p.y < q.y : p.x < q.x;
  });
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const std::uint32_t block_row = tile.blocks[order[begin]].y;
    while (end < order.size() && tile.blocks[order[end]].y == block_row) ++end;
    for (int j = 0; j < kBlockSamples; ++j) {
      builder.begin_row(block_row * kBlockSamples + j);
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t b = order[k];
        const std::size_t row = static_cast<std::size_t>(b / kPackedColumns) * kBlockSamples + j;
        const std::size_t column = static_cast<std::size_t>(b % kPackedColumns) * kBlockSamples;
        builder.append(row * tile.width + column, static_cast<std::uint32_t>(tile.blocks[b].x) * kBlockSamples,
                       kBlockSamples, 0, kBlockSamples);
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

template <class T>
std::size_t heap_bytes(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

}  // namespace

std::size_t Splats::memory_bytes() const {
  return heap_bytes(runs) + heap_bytes(links) + heap_bytes(disparity) + heap_bytes(colour) + heap_bytes(reach) +
         blocks.memory_bytes();
}

Splats build_splats(const Tile& tile) {
  Splats splats;
  splats.face = tile.id.face;
  splats.pitch = static_cast<float>(sample_pitch(tile.edge_samples));
  const std::size_t covered =
      static_cast<std::size_t>(std::count_if(tile.coverage.begin(), tile.coverage.end(), [](auto c) { return c != 0; }));
  splats.disparity.reserve(covered);
  splats.colour.reserve(covered);
  splats.reach.reserve(covered);
  SplatsBuilder builder(tile, splats);
  if (tile.is_packed()) {
    append_packed(tile, builder);
  } else {
    append_dense(tile, builder);
  }
  builder.finish();
  find_bounds(splats);
  splats.blocks = find_blocks(splats);
  return splats;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/splats.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/impostor/drawn_samples.h"
#include "common/impostor/tile_neighbours.h"
#include "common/math/cube_face.h"

namespace farfield {
namespace {

/// Appends the covered samples of `tile` row by row; those to be drawn form runs, open while samples stay adjacent. Of those
/// in pieces only the neighbours of others are held.
class SplatsBuilder {
 public:
  SplatsBuilder(const Tile& tile, const InPieces& in_pieces, Splats& splats)
      : tile_(tile), in_pieces_(in_pieces), neighbours_(tile), splats_(splats), place_(tile.samples(), kNotHeld) {}

  void begin_row(std::uint32_t face_row) {
    v_ = static_cast<float>(sample_tangent(tile_.edge_samples, face_row));
    is_open_ = false;
  }

  /// `count` samples from array index `index`; the first stands at `face_column`. Those numbered [first_drawn, end_drawn)
  /// join runs.
  void append(std::size_t index, std::uint32_t face_column, int count, int first_drawn, int end_drawn) {
    for (int i = 0; i < count; ++i, ++index, ++face_column) {
      if (!tile_.coverage[index]) continue;
      const bool is_drawn = i >= first_drawn && i < end_drawn && !in_pieces_[index];
      if (!is_drawn && splats_.pieces.samples > 0 && !is_beside_drawn(static_cast<int>(index))) continue;
      if (is_drawn) {
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
    splats_.runs.shrink_to_fit(), splats_.links.shrink_to_fit();
    splats_.disparity.shrink_to_fit(), splats_.colour.shrink_to_fit(), splats_.reach.shrink_to_fit();
  }

 private:
  static constexpr std::uint32_t kNotHeld = ~0u;

  /// Whether a neighbour may be drawn by itself and need this one's disparity and colour.
  bool is_beside_drawn(int index) const {
    const auto is_single = [&](int other) { return other >= 0 && tile_.coverage[other] && !in_pieces_[other]; };
    return is_single(neighbours_.left(index)) || is_single(neighbours_.right(index)) ||
           is_single(neighbours_.up(index)) || is_single(neighbours_.down(index));
  }
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
    splats_.reach.push_back(
        reach_of_sample(tile_, index, left, neighbours_.right(index), up, neighbours_.down(index)));
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
  const InPieces& in_pieces_;
  const TileNeighbours neighbours_;
  Splats& splats_;
  std::vector<std::uint32_t> place_;  // by tile index: where the sample is held
  std::vector<int> index_;            // and back
  float v_ = 0;
  std::uint32_t next_column_ = 0;
  bool is_open_ = false;
};

void append_dense(const Tile& tile, SplatsBuilder& builder) {
  const DrawnSamples drawn(tile);
  const std::uint32_t face_column = static_cast<std::uint32_t>(tile.id.x) * kTileStride;
  const std::uint32_t face_row = static_cast<std::uint32_t>(tile.id.y) * kTileStride;
  for (int j = 0; j < tile.height; ++j) {
    const bool is_drawn = j >= drawn.first_row && j < drawn.end_row;
    builder.begin_row(face_row + j);
    builder.append(static_cast<std::size_t>(j) * tile.width, face_column, tile.width, drawn.first_column,
                   is_drawn ? drawn.end_column : 0);
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

/// Of everything that is drawn.
void find_bounds(Splats& splats) {
  if (splats.drawn == 0) return;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  splats.min_disparity = splats.u_min = splats.v_min = kInfinity;
  splats.max_disparity = splats.u_max = splats.v_max = -kInfinity;
  const auto include = [&](float u, float u_end, float v, float v_end) {
    splats.u_min = std::min(splats.u_min, u), splats.u_max = std::max(splats.u_max, u_end);
    splats.v_min = std::min(splats.v_min, v), splats.v_max = std::max(splats.v_max, v_end);
  };
  for (const float disparity : splats.disparity) {
    splats.min_disparity = std::min(splats.min_disparity, disparity);
    splats.max_disparity = std::max(splats.max_disparity, disparity);
  }
  for (const SplatRun& run : splats.runs)
    include(run.u0, run.u0 + static_cast<float>(run.count - 1) * splats.pitch, run.v, run.v);
  for (const PieceSquare& square : splats.pieces.squares) {
    splats.min_disparity = std::min(splats.min_disparity, square.lowest);
    splats.max_disparity = std::max(splats.max_disparity, square.highest);
    const float u = splats.tangent(square.column), v = splats.tangent(square.row);
    const float length = static_cast<float>(kSquareEdge - 1) * splats.pitch;
    include(u, u + length, v, v + length);
  }
}

template <class T>
std::size_t heap_bytes(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

}  // namespace

std::size_t Splats::memory_bytes() const {
  return heap_bytes(runs) + heap_bytes(links) + heap_bytes(disparity) + heap_bytes(colour) + heap_bytes(reach) +
         blocks.memory_bytes() + pieces.memory_bytes();
}

Splats build_splats(const Tile& tile, bool with_pieces) {
  Splats splats;
  splats.face = tile.id.face;
  splats.pitch = static_cast<float>(sample_pitch(tile.edge_samples));
  splats.first_tangent = static_cast<float>(sample_tangent(tile.edge_samples, 0));
  InPieces in_pieces(tile.samples(), 0);
  if (with_pieces) splats.pieces = find_surface_pieces(tile, in_pieces);
  splats.drawn = splats.pieces.samples;
  SplatsBuilder builder(tile, in_pieces, splats);
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

// SPDX-License-Identifier: Apache-2.0
// The nodes of the disparity codec's quadtree, and the connected surfaces in one of them.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "common/codec/tile_bits.h"

namespace farfield {

inline constexpr int kLargestNode = 32, kSmallestNode = 4;

struct Node {
  int x, y, size;  // in the tile; size: kLargestNode … kSmallestNode, a power of two
};

/// Samples of a node: bit x of rows[y], from the node's first sample.
struct NodeSamples {
  std::array<std::uint32_t, kLargestNode> rows{};
  int first_row = 0, end_row = 0;  // rows outside are empty

  /// Calls visit(y, first x, end x) for each run of samples, in raster order, relative to the node.
  template <class Visit>
  void each_run(Visit visit) const {
    for (int y = first_row; y < end_row; ++y)
      for (std::uint64_t row = rows[y]; row != 0;) {
        const int first = std::countr_zero(row), end = first + std::countr_one(row >> first);
        visit(y, first, end);
        row = row >> end << end;
      }
  }
  bool operator==(const NodeSamples&) const = default;
  static NodeSamples whole(int size) {
    NodeSamples all{.first_row = 0, .end_row = size};
    for (int y = 0; y < size; ++y) all.rows[y] = 0xffffffffu >> (32 - size);
    return all;
  }
};

/// No sample of the node is covered.
bool is_empty(const TileBits& bits, const Node& node);
/// One surface over the whole node: covered everywhere, cut nowhere inside.
bool is_whole(const TileBits& bits, const Node& node);

/// The connected surfaces of a node, in raster order of their first samples. Packed tiles: nodes never reach across
/// blocks, so image neighbours are face neighbours.
class NodeSurfaces {
 public:
  NodeSurfaces(const TileBits& bits, const Node& node);
  /// The next surface. Returns: whether there was one.
  bool next(NodeSamples& surface);

 private:
  int size_, row_ = 0;
  std::array<std::uint32_t, kLargestNode> left_{}, joined_right_{}, joined_below_{};
};

}  // namespace farfield

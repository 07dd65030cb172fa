// SPDX-License-Identifier: Apache-2.0
// One block of a packed tile with a border of one sample from its neighbours on the face.
//
// Neighbours on the face are rarely neighbours in the packed image. A window of 10×10 samples brings them together,
// so that meshing works as on a dense tile, and as a 10×10 piece of texture it lets colours be interpolated across
// the block's edge.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/impostor/surface_patch.h"
#include "common/impostor/tile.h"

namespace farfield {

inline constexpr int kWindowSamples = kBlockSamples + 2;

/// Finds blocks by their place on the face.
class BlockMap {
 public:
  explicit BlockMap(const Tile& tile);
  /// Returns: the block's index, or -1. Any place may be asked for.
  int find(int x, int y) const;

 private:
  std::unordered_map<std::uint32_t, int> index_of_;
};

/// Window sample (x, y) is block sample (x-1, y-1).
class BlockWindow {
 public:
  void load(const Tile& tile, const BlockMap& map, std::size_t block);
  SurfacePatch patch() const;
  /// Clears the quads that another block draws: each belongs to the first present one of the blocks of its upper
  /// left, upper right, lower left and lower right corner.
  void leave_to_neighbours(std::vector<QuadKind>& kinds) const;

  /// Between marks over the window and marks over the tile's samples.
  void store_used(const std::vector<std::uint8_t>& window, std::vector<std::uint8_t>& tile) const;
  void load_used(const std::vector<std::uint8_t>& tile, std::vector<std::uint8_t>& window) const;
  /// Writes the window's texels; missing ones repeat the block's nearest. `row_texels`: from row to row.
  void copy_texels(const Tile& tile, std::uint8_t* rgb, int row_texels) const;

 private:
  static constexpr int kCount = kWindowSamples * kWindowSamples;
  bool has_block(int dx, int dy) const { return neighbours_[(dy + 1) * 3 + dx + 1] >= 0; }

  std::array<int, 9> neighbours_{};      // block indices around, -1: none
  std::array<std::int64_t, kCount> source_{};  // index into the tile's arrays, -1: none
  std::array<std::uint8_t, kCount> coverage_{}, cut_right_{}, cut_down_{};
  std::array<float, kCount> disparity_{};
};

}  // namespace farfield

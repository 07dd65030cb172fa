// SPDX-License-Identifier: Apache-2.0
// Names of tiles, and how a view's faces are cut into them.
#pragma once

#include <compare>
#include <cstdint>

#include "common/base/hash.h"
#include "common/cells/cell_id.h"

namespace farfield {

/// Samples along an edge of a tile, and from one tile's first sample to the next's. Adjacent tiles share two rows of
/// samples, so that meshes made from each tile alone overlap by one sample instead of leaving a crack.
inline constexpr int kTileSamples = 128;
inline constexpr int kTileStride = kTileSamples - 2;
/// Side of the blocks in which delta views are packed: the colour transform's, so that packing costs no extra coefficients.
inline constexpr int kBlockSamples = 8;
/// A delta view's face is divided into regions of this many blocks along an edge (16·8 = 128 samples).
inline constexpr int kRegionBlocks = 16;
inline constexpr int kRegionSamples = kRegionBlocks * kBlockSamples;

inline constexpr std::uint8_t kIntraView = 0;
inline constexpr std::uint8_t kMaxDeltaViews = 32;
/// The fallback view (design.md section 2): everything beyond the cell's near surroundings
/// (NestedShells::fallback_region()), at a quarter of the resolution.
inline constexpr std::uint8_t kFallbackView = 255;

/// Samples along a face's edge for `tiles` tiles.
inline constexpr int face_samples(int tiles) { return tiles * kTileStride + 2; }
inline constexpr int face_tiles(int samples) { return (samples - 2) / kTileStride; }
/// Regions along a delta face's edge.
inline constexpr int face_regions(int samples) { return (samples + kRegionSamples - 1) / kRegionSamples; }

/// One tile. For intra and fallback views (x, y) counts tiles, for delta views regions.
struct TileId {
  CellId cell;
  std::uint8_t view = kIntraView;
  std::uint8_t face = 0;
  std::uint8_t x = 0, y = 0;

  auto operator<=>(const TileId&) const = default;
  bool is_delta() const { return view != kIntraView && view != kFallbackView; }
};

}  // namespace farfield

template <>
struct std::hash<farfield::TileId> {
  std::size_t operator()(const farfield::TileId& t) const {
    const std::uint64_t low = t.view | (t.face << 8) | (t.x << 16) | (std::uint64_t{t.y} << 24);
    return std::hash<farfield::CellId>()(t.cell) ^ static_cast<std::size_t>(low * 0x9e3779b97f4a7c15ull);
  }
};

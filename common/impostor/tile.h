// SPDX-License-Identifier: Apache-2.0
// A tile: a block of samples of one view's face, as the encoder takes it and the decoder returns it.
//
// Dense tiles (intra, fallback views) are kTileSamples² samples; sample (i, j) is face sample
// (x·kTileStride + i, y·kTileStride + j). Packed tiles (delta views) hold only blocks of kBlockSamples² samples that
// contain something: block b stands at column b mod kPackedColumns, row b / kPackedColumns of an image
// kPackedColumns blocks wide, and its place on the face is blocks[b], in blocks from the face's first sample.
// All arrays are [row][column] over `width` × `height`.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "common/impostor/certificate.h"
#include "common/impostor/tile_id.h"

namespace farfield {

inline constexpr int kPackedColumns = 16;

struct BlockPlace {
  std::uint16_t x = 0, y = 0;
  auto operator<=>(const BlockPlace&) const = default;
};

/// Where a connection between neighbouring samples is cut: kConnected, or 1…8 in eighths of the sample spacing:
/// the surface of the first (left, upper) sample ends at (cut - ½)/8 of the way to the second.
inline constexpr std::uint8_t kConnected = 0;

struct Tile {
  TileId id;
  int edge_samples = 0;          // N: samples along the face's edge
  glm::vec3 view_offset{0};      // the view's position relative to the cell's centre, in units of the cell's side
  int width = 0, height = 0;
  std::vector<BlockPlace> blocks;       // packed tiles only; sorted, unique
  std::vector<std::uint8_t> coverage;   // 1: holds a surface
  std::vector<float> disparity;         // 1/z along the face's axis, in 1/(cell side): scale-free
  std::vector<std::uint8_t> rgb;        // sRGB, 3 bytes per sample
  std::vector<std::uint8_t> cut_right;  // between (i, j) and (i+1, j) on the face; 0 where either is not covered
  std::vector<std::uint8_t> cut_down;   // between (i, j) and (i, j+1)
  float disparity_tolerance = 0;        // guaranteed |decoded - exact| of disparity, in 1/(cell side)
  Certificate certificate;

  bool is_packed() const { return id.is_delta(); }
  std::size_t samples() const { return static_cast<std::size_t>(width) * height; }
};

}  // namespace farfield

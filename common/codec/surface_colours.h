// SPDX-License-Identifier: Apache-2.0
// The base colour of every surface of a tile, taken out of the image before its colours are coded.
//
// Coverage and cuts, which the decoder has, say where one surface ends and another begins. With each surface's own
// level taken out, the edges between surfaces, which block transforms code worst, are gone from the image: flat-coloured
// models leave almost nothing, and what is left does not ring. Related: region-based predictive coding; the papers here
// send their textures whole (Wilson & Manocha 2003, section 5.3).
#pragma once

#include "common/base/bytes.h"
#include "common/codec/tile_bits.h"

namespace farfield {

/// Surfaces of a tile: maximal sets of covered samples joined by uncut connections, on the face, so also across packed
/// blocks. Numbered in raster order of their first samples.
struct Surfaces {
  /// Samples side by side in a row of the tile's arrays.
  struct Run {
    std::int32_t first, count, surface;
  };
  std::vector<Run> runs;                // all covered samples, in raster order
  std::vector<std::int32_t> of_sample;  // -1: uncovered
  std::int32_t count = 0;
};

/// `bits`: of the tile. O(samples).
Surfaces find_surfaces(const Tile& tile, const TileBits& bits);

/// Replaces each covered colour by its difference from its surface's base colour, plus 128; the base is chosen so that
/// this stays within a byte (within three levels, if a surface holds both black and white). Uncovered samples become the
/// 128 that surfaces vary around: they cost next to nothing and do not ring. Returns: the bases, coded.
Bytes take_out_base_colours(const Surfaces& surfaces, std::vector<std::uint8_t>& rgb);

/// The reverse, clamped. Any bytes give some colours; nothing is read beyond them.
void put_back_base_colours(ByteView bytes, const Surfaces& surfaces, std::vector<std::uint8_t>& rgb);

}  // namespace farfield

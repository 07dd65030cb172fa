// SPDX-License-Identifier: Apache-2.0
// A packed tile laid out as its blocks stand on the face, so that it is meshed and textured like a dense one: surfaces
// run on across blocks, and a texel's place follows from its sample's.
//
// Samples: the blocks' bounding rectangle with a border of one uncovered sample, towards which surfaces end half a
// sample outside. Texels: the rectangle without that border.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/surface_patch.h"
#include "common/impostor/tile.h"

namespace farfield {

struct UnpackedBlocks {
  int face_x = 0, face_y = 0;  // of sample (0, 0), on the face; -1 where the rectangle begins at the face's edge
  int width = 0, height = 0;   // in samples, with the border
  std::vector<std::uint8_t> coverage, cut_right, cut_down;
  std::vector<float> disparity;
  std::vector<std::uint8_t> rgb;  // (width - 2) × (height - 2); texels beside a block repeat its nearest, others are black

  SurfacePatch patch() const {
    return {width, height, coverage.data(), disparity.data(), cut_right.data(), cut_down.data()};
  }
};

/// Whether all blocks lie within one region, as the tile codec sees to: then the result is bounded, whatever the blocks.
bool is_one_region(const Tile& tile);

/// `rgb`: the tile's colours, with something sensible where nothing is covered. Requires: tile.is_packed(), at least one
/// block, is_one_region(tile). O(samples of the rectangle).
UnpackedBlocks unpack_blocks(const Tile& tile, const std::vector<std::uint8_t>& rgb);

}  // namespace farfield

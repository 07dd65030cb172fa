// SPDX-License-Identifier: Apache-2.0
// Which squares of a tile's samples can change a window of the screen: those that can land in it, in front of what is
// there already. Tiles come nearest shell first, so most of what a viewer in a dense scene cannot see ends here.
//
// Never leaves out a sample that would change a key: the picture is the same with and without it.
//
// Based on: Greene, Kass & Miller 1993 (hierarchical visibility). Differs: the pixels themselves are asked, as a square's
// rectangle is small, instead of a pyramid above them.
#pragma once

#include <array>
#include <cstdint>

#include "client/warp/project_row.h"
#include "client/warp/tile_projection.h"
#include "common/impostor/splats.h"

namespace farfield::client {

/// For each row of splats.blocks: bit c tells that the square in column c is to be drawn.
using VisibleBlocks = std::array<std::uint32_t, SplatBlocks::kColumns>;

/// `keys`: the whole frame's, row by row; only rows of `window` are read.
VisibleBlocks find_visible_blocks(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                  const std::uint64_t* keys);

}  // namespace farfield::client

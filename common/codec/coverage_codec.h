// SPDX-License-Identifier: Apache-2.0
// Which samples hold a surface, and where connections are cut: the topology of a tile, losslessly.
#pragma once

#include "common/base/bytes.h"
#include "common/codec/tile_bits.h"

namespace farfield {

/// Format: see coverage_codec.cpp. Requires: arrays of the tile's size; cuts in 0…8, non-zero wherever exactly one end
/// is covered, zero where neither is.
/// `bits`: of the tile.
Bytes encode_topology(const Tile& tile, const TileBits& bits);
/// Fills coverage, cut_right and cut_down of `tile`, whose size and blocks are set. Any bytes give some topology.
void decode_topology(ByteView bytes, Tile& tile);

}  // namespace farfield

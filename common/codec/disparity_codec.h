// SPDX-License-Identifier: Apache-2.0
// Disparity of a tile, coded as planes to a guaranteed error.
//
// Planes of the scene are exactly planar in (u, v, 1/z), so most of a built scene is a few planes: a quadtree of nodes
// of 32 … 4 samples holds one plane per connected surface; what no plane fits within the tolerance is coded sample by
// sample in steps of twice the tolerance. Integer arithmetic throughout: every decoder gives the same floats.
#pragma once

#include "common/base/bytes.h"
#include "common/codec/tile_bits.h"

namespace farfield {

/// How many tolerances a disparity may be large. At 2^15 the float that the decoder rounds to is off by at most 2^-24 of it,
/// half of a unit of tolerance/256, for which plane_fit() and the levels leave one.
inline constexpr float kMostTolerances = 32768;

/// Requires: coverage and cuts as decode_topology will return them (`bits`: theirs), 0 <= disparity <= kMostTolerances
/// tolerances where covered, tolerance > 0, sides of whole nodes.
/// Guarantee: |decoded - tile.disparity| <= tile.disparity_tolerance for every covered sample.
/// `decoded`: if given, becomes the disparities that decode_disparity() will return.
Bytes encode_disparity(const Tile& tile, const TileBits& bits, std::vector<float>* decoded = nullptr);
/// Fills tile.disparity; coverage, cuts (`bits`: theirs) and disparity_tolerance are set. Any bytes give some finite disparities >= 0;
/// uncovered samples get 0.
void decode_disparity(ByteView bytes, const TileBits& bits, Tile& tile);

}  // namespace farfield

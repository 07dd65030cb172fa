// SPDX-License-Identifier: Apache-2.0
// The quantised colour coefficients of a tile's blocks, and their lossless coding.
//
// Based on: the modelling of JPEG coefficients by their neighbours in the blocks to the left and above (D. R. Horn et al.,
// "The design, implementation, and deployment of a system to transparently compress hundreds of petabytes of image files",
// NSDI 2017, section 3.3). Differs: each decision mixes three such contexts; neighbours are those on the face; how many
// samples a block covers is a context, and blocks that cover none are not coded.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/base/bytes.h"
#include "common/codec/tile_bits.h"

namespace farfield {

inline constexpr int kColourPlanes = 3;  // luma, blue less luma, red less luma: as in JPEG

/// Levels of a block's coefficients, [row][column]; magnitudes of at most kLargestLevel.
inline constexpr int kLargestLevel = 32767;
struct ColourBlock {
  std::array<std::array<std::int16_t, kBlockSamples * kBlockSamples>, kColourPlanes> levels{};
};

/// The order in which JPEG counts coefficients (ITU-T T.81, figure A.6): place in a block of the k-th.
inline constexpr std::array<std::uint8_t, 64> kZigZag = {
    0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,  12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6,  7,  14, 21, 28,
    35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};

/// `blocks`: one for each of the grid; those that cover nothing are not kept. They are what the decoder will see afterwards.
Bytes encode_colour_blocks(std::vector<ColourBlock>& blocks, const TileBits& bits);
/// Any bytes give some levels. Time and memory: bounded by the grid.
std::vector<ColourBlock> decode_colour_blocks(ByteView bytes, const TileBits& bits);

}  // namespace farfield

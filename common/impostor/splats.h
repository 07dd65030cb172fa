// SPDX-License-Identifier: Apache-2.0
// The layered-depth-image form of a tile for the CPU warper: its covered samples as splats, in rows.
//
// Based on: Shade et al. 1998 and Aliaga 1998 chapter 4. Differs: deeper layers (delta views) keep their own view's
// exact grid positions instead of being resampled into the intra view's grid, so the form adds no error of its own; and
// a splat is the sample's cell on its surface, with the surface's slopes and its neighbours' colours, not a disc.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "common/impostor/tile.h"

namespace farfield {

/// A run of consecutive covered samples in one face row.
struct SplatRun {
  float u0 = 0, v = 0;           // tangent coordinates of the first sample; the next is u0 + pitch
  std::uint32_t first = 0;       // index of its first sample in the arrays below
  std::uint32_t count = 0;
};

/// How far a sample's surface reaches towards a neighbour, in sixteenths of the sample spacing. A recorded cut gives an
/// odd number; towards a neighbour of the same surface, splats overlap a little, as curved surfaces need it.
inline constexpr std::uint32_t kReachToNothing = 8;     // nothing is known of what lies there
inline constexpr std::uint32_t kReachConnected = 10;    // the neighbour is the next (or previous) one of the same run
inline constexpr std::uint32_t kReachOutOfRun = 9;      // connected, but held by the next tile
/// Four reaches as nibbles: left, right, up, down from the lowest. Left and right are along u, up and down along v
/// (down: towards larger v).
inline constexpr std::uint16_t pack_reach(std::uint32_t left, std::uint32_t right, std::uint32_t up,
                                          std::uint32_t down) {
  return static_cast<std::uint16_t>(left | right << 4 | up << 8 | down << 12);
}
inline constexpr std::uint16_t kReachHalfway =
    pack_reach(kReachToNothing, kReachToNothing, kReachToNothing, kReachToNothing);

/// Disparity slopes per sample along u (upper half) and v (lower half), each the upper 16 bits of its float: to 1/256.
inline std::uint32_t pack_slopes(float along_u, float along_v) {
  const auto rounded = [](float value) { return std::bit_cast<std::uint32_t>(value) + 0x8000u; };
  return (rounded(along_u) & 0xffff0000u) | rounded(along_v) >> 16;
}

/// The arrays from `disparity` on hold one entry per sample, 22 bytes together.
struct Splats {
  int face = 0;
  float pitch = 0;                       // sample spacing in tangent units
  float min_disparity = 0, max_disparity = 0;
  float u_min = 0, u_max = 0, v_min = 0, v_max = 0;
  std::vector<SplatRun> runs;
  std::vector<float> disparity;          // 1/(cell side)
  std::vector<std::uint32_t> slopes;     // pack_slopes(), 1/(cell side) per sample; 0 without a connected neighbour
  std::vector<std::uint32_t> colour;     // 0x00BBGGRR sRGB
  std::vector<std::uint32_t> colour_up, colour_down;  // of the connected neighbours along v; else the sample's own
  std::vector<std::uint16_t> reach;      // pack_reach()

  std::size_t size() const { return disparity.size(); }
};

/// Dense tiles leave out the first and last rows and columns, which the tiles before and after hold. O(samples).
Splats build_splats(const Tile& tile);

}  // namespace farfield

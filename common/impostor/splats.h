// SPDX-License-Identifier: Apache-2.0
// The layered-depth-image form of a tile for the CPU warper: its covered samples as splats, in rows.
//
// Based on: Shade et al. 1998 and Aliaga 1998 chapter 4. Differs: deeper layers (delta views) keep their own view's
// exact grid positions instead of being resampled into the intra view's grid, so the form adds no error of its own.
#pragma once

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

struct Splats {
  int face = 0;
  float pitch = 0;                       // sample spacing in tangent units
  float min_disparity = 0, max_disparity = 0;
  float u_min = 0, u_max = 0, v_min = 0, v_max = 0;
  std::vector<SplatRun> runs;
  std::vector<float> disparity;          // 1/(cell side)
  std::vector<std::uint32_t> colour;     // 0x00BBGGRR sRGB

  std::size_t size() const { return disparity.size(); }
};

/// Dense tiles leave out the rows and columns they share with the next tile. O(samples).
Splats build_splats(const Tile& tile);

}  // namespace farfield

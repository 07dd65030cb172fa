// SPDX-License-Identifier: Apache-2.0
// Bounds of a tile's splats in squares of its face: what lets a renderer leave out whole squares that lie outside the
// frame or behind what is drawn already.
//
// A tile's rectangle, from (u_min, v_min) on, is divided into at most kColumns × kColumns squares of `edge` samples, 8 in
// tiles of usual extent; whatever bytes a tile came from, they take 2 kB.
#pragma once

#include <cstdint>
#include <vector>

namespace farfield {

struct Splats;
struct SplatRun;

struct SplatBlocks {
  static constexpr int kColumns = 16;

  int edge = 1;  // samples
  int rows = 0;
  /// [row][column]: bounds of the disparity anywhere on the surface within one sample of the square's samples, along the
  /// slopes its splats are drawn with; lowest > highest: the square holds none. After the last row, column j bounds all
  /// of row j.
  std::vector<float> lowest, highest;
  std::vector<std::uint32_t> first_run;  // of each row of squares, and the number of runs after the last

  std::size_t memory_bytes() const {
    return (lowest.capacity() + highest.capacity()) * sizeof(float) + first_run.capacity() * sizeof(std::uint32_t);
  }
};

/// The column of a run's first sample, counted from the tile's first column.
int first_column(const Splats& splats, const SplatRun& run);

/// Requires: everything else in `splats` is filled in; runs come by rows. O(samples).
SplatBlocks find_blocks(const Splats& splats);

}  // namespace farfield

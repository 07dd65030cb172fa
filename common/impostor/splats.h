// SPDX-License-Identifier: Apache-2.0
// The layered-depth-image form of a tile for the CPU warper: its covered samples as splats, in rows.
//
// Based on: Shade et al. 1998 and Aliaga 1998 chapter 4. Differs: deeper layers (delta views) keep their own view's
// exact grid positions instead of being resampled into the intra view's grid, so the form adds no error of its own; and
// a splat is the sample's cell on its surface, with the surface's slopes and colours towards its neighbours, not a disc.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/splat_blocks.h"
#include "common/impostor/splat_reach.h"
#include "common/impostor/surface_pieces.h"
#include "common/impostor/tile.h"

namespace farfield {

/// A run of consecutive covered samples in one face row.
struct SplatRun {
  float u0 = 0, v = 0;           // tangent coordinates of the first sample; the next is u0 + pitch
  std::uint32_t first = 0;       // index of its first sample in the arrays below
  std::uint32_t count = 0;
};

/// Where the neighbours along v of samples from `first` on stand: `up` entries before them, `down` entries after them.
/// Holds until the next link begins, for the samples connected to such a neighbour; the others may ignore it, but the
/// place it names is within the arrays.
struct SplatLink {
  std::uint32_t first = 0;
  std::uint16_t up = 0, down = 0;
};

/// What is plane stands in `pieces`; the rest, sample by sample, in the arrays.
///
/// The arrays from `disparity` on hold one entry per sample, 10 bytes together, by rows of the face. A sample connected
/// to its left or right neighbour has it as the entry before or after its own, whether or not that is in a run; one
/// connected along v finds it by the links. Slopes and the colours between samples follow from the neighbours. Samples in
/// no run are held for that alone.
struct Splats {
  int face = 0;
  float pitch = 0;                       // sample spacing in tangent units
  float min_disparity = 0, max_disparity = 0;                // of all that is drawn
  float u_min = 0, u_max = 0, v_min = 0, v_max = 0;
  std::uint32_t drawn = 0;               // samples in runs and pieces
  SurfacePieces pieces;
  float first_tangent = 0;               // of the face's sample (0, 0), along u and v: what squares count from
  std::vector<SplatRun> runs;
  std::vector<SplatLink> links;          // by ascending `first`; the first begins at 0
  std::vector<float> disparity;          // 1/(cell side)
  std::vector<std::uint32_t> colour;     // 0x00BBGGRR sRGB
  std::vector<std::uint16_t> reach;      // pack_reach()
  SplatBlocks blocks;                    // find_blocks()

  std::size_t size() const { return disparity.size(); }
  /// Of a column or row of the face.
  float tangent(int index) const { return first_tangent + pitch * static_cast<float>(index); }
  std::size_t memory_bytes() const;      // on the heap
};

/// Of the rows and columns a dense tile shares with its neighbours, the outer ones are in no run: the tiles before and
/// after draw them. No array keeps spare capacity. O(samples).
Splats build_splats(const Tile& tile, bool with_pieces = kPiecesAreFaster);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Colours from several rays per sample, where one is not enough: at edges, in fine texture, and along things thinner than a
// sample.
#pragma once

#include "server/impostor/connectivity.h"

namespace farfield {

/// Replaces colours in `samples.rgb` by the mean of four rays, in linear light: of the tile's samples whose surface ends on two
/// opposite sides, of those that differ from a connected neighbour where no texture filter smoothed them, and then of
/// neighbours of those whose own rays meet something nearer or of another colour: a thin thing is followed wherever it goes.
/// What lies beyond a cut is left to the sample on its other side. The other samples would look the same.
/// Requires: find_cuts() was run on `tile`. Sets samples.refined.
void supersample_colours(const Scene& scene, const CellSpace& space, const ViewFrame& frame,
                         const ConnectionLimits& limits, const TileNeighbours& neighbours,
                         const std::vector<int>& sample_i, const std::vector<int>& sample_j, const Tile& tile,
                         SampleArrays& samples);

}  // namespace farfield

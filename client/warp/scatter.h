// SPDX-License-Identifier: Apache-2.0
// Draws a tile's splats into a band of the key buffer: leave out squares of samples that nobody can see, gather what is
// left into pieces, project each, then keep, per pixel, what is nearest.
#pragma once

#include <cstdint>

#include "client/warp/project_row.h"
#include "client/warp/shown_depths.h"
#include "client/warp/tile_projection.h"
#include "common/impostor/splats.h"

namespace farfield::client {

enum class ProjectionKernel { kVector, kScalar };

/// `keys`: the whole frame's, row by row; only rows of `window` are written. `shown`: of the same window and keys. One thread
/// per window.
void scatter_tile(const Splats& splats, const TileProjection& projection, const PixelWindow& window,
                  ProjectionKernel kernel, ShownDepths& shown, std::uint64_t* keys);

}  // namespace farfield::client

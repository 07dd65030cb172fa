// SPDX-License-Identifier: Apache-2.0
// Splats of more than kNarrow pixels a side: of surfaces that the eye has come closer to than their view stood.
#pragma once

#include <cstdint>

#include "client/warp/project_row.h"

namespace farfield::client {

/// Draws splat i of a projected piece into rows of `width` keys, in blocks of 4×4 pixels, each one vector operation.
/// Requires: row.wide[i] is 0.
void draw_wide_splat(const ProjectedRow& row, const RowSamples& samples, int i, int width, std::uint64_t* keys);

/// The reference, for all wide splats of the piece: pass after pass, the pixels at one place of every splat's rectangle.
void draw_wide_splats_scalar(const ProjectedRow& row, const RowSamples& samples, int width, std::uint64_t* keys);

}  // namespace farfield::client

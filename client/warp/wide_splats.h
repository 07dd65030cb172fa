// SPDX-License-Identifier: Apache-2.0
// Splats that may cover more than one pixel: every second one, where deeper layers are sampled more coarsely.
#pragma once

#include <cstdint>

#include "client/warp/project_row.h"

namespace farfield::client {

/// Draws splat i of a projected piece into rows of `width` keys, in blocks of 4×4 pixels, each one vector operation.
/// Requires: row.wide[i] is 0.
void draw_wide_splat(const ProjectedRow& row, const RowSamples& samples, int i, int width, std::uint64_t* keys);

/// The reference, for all splats of the piece: pass after pass, the pixels at one place of every splat's rectangle.
void draw_wide_splats_scalar(const ProjectedRow& row, const RowSamples& samples, int width, std::uint64_t* keys);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// Colours made ready for the client's bilinear look-ups, which blur: the low pass of interpolation is taken back before coding.
//
// Based on: Unser, "Sampling - 50 years after Shannon", Proceedings of the IEEE 88(4), 2000 (section IV: a basis that does not
// interpolate wants a prefilter). Differs: the tent interpolates, yet on average over all places between samples it blurs like
// a box of one more sample, and what it should give is a pixel's mean; a prefilter of three taps makes up for the average.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/tile.h"

namespace farfield {

/// Changes `rgb` (as Tile::rgb) of samples that have neighbours of their own surface on both sides, per direction: by
/// kSharpening times what they differ from them. Values are sRGB, as clients interpolate them. Nothing crosses a cut of
/// `tile`, whose colours are not read. Linear in the samples; about 1 ns each.
void sharpen_colours(const Tile& tile, std::vector<std::uint8_t>& rgb);

/// Of 64. A sample of spacing s (pixels) that is the mean of its area (variance s²/12), interpolated by a tent (s²/6), should
/// have the variance of a pixel, 1/12; three taps (-a, 1 + 2a, -a) take 2a·s² away: a = 1/8 - 1/(24 s²), which is 0.08 for
/// s = 1 and 0.06 for 0.8, where cells are seen from their centre. Measured best with kFootprint: see view_frame.h.
inline constexpr int kSharpening = 5;

}  // namespace farfield

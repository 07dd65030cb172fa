// SPDX-License-Identifier: Apache-2.0
// The colour spaces of FLIP: linear RGB, YCxCz (linear, for filtering) and Hunt-adjusted L*a*b* (for differences).
#pragma once

#include <array>
#include <cstdint>

namespace farfield {

using Colour3 = std::array<float, 3>;

Colour3 linear_rgb_from_srgb(const std::uint8_t* srgb);
Colour3 ycxcz_from_linear_rgb(const Colour3& rgb);
Colour3 linear_rgb_from_ycxcz(const Colour3& ycxcz);
/// L*, and a*, b* scaled by L*/100 (Hunt effect: what is dark looks less colourful).
Colour3 hunt_lab_from_linear_rgb(const Colour3& rgb);
/// Hybrid city-block and Euclidean distance (Abasi et al. 2020).
float hyab_distance(const Colour3& a, const Colour3& b);

}  // namespace farfield

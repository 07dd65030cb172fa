// SPDX-License-Identifier: Apache-2.0
// The colours of a rasterised triangle's pixels, once it is known which pixels show it: every pixel is shaded once.
//
// Based on: Burns & Hunt 2013 (The visibility buffer: a cache-friendly approach to deferred shading).
#pragma once

#include <cstdint>

#include "client/near_cpu/raster_triangle.h"

namespace farfield::client {

/// Pixels [begin, end) of row `y`, at `keys`, show `triangle`: sets their lower halves to those of near_key().
void shade_pixels(const RasterTriangle& triangle, int y, int begin, int end, std::uint64_t* keys);

}  // namespace farfield::client

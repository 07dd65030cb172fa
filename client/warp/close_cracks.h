// SPDX-License-Identifier: Apache-2.0
// Turns scattered keys into colours, disparities and coverage classes, closing cracks one pixel wide on the way.
//
// A surface that the warp stretches, or that parts of different views show, opens cracks, through which nothing or a farther surface shows. A pixel is a crack
// if impostor pixels on opposite sides of it (four such pairs) agree in disparity and are much nearer than what it
// shows: one pair is enough where nothing landed, three are needed to overrule a farther surface, as a line of such
// pixels has them and the silhouette of a thin object does not. Near geometry is exact: it neither closes nor is closed.
#pragma once

#include <cstdint>

#include "client/warp/frame_image.h"

namespace farfield::client {

struct ResolveCounts {
  std::uint64_t crack_pixels = 0;
  std::uint64_t uncovered_pixels = 0;  // left as Coverage::kBackground
};

/// Writes rows [first_row, last_row) of `frame` (sized already) from the keys of the whole frame; reads one row more
/// on either side. Uncovered pixels get `background` (0x00BBGGRR). Any number of threads on different rows.
ResolveCounts resolve_rows(const std::uint64_t* keys, int first_row, int last_row, std::uint32_t background,
                           Frame& frame);

}  // namespace farfield::client

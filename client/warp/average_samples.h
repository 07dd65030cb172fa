// SPDX-License-Identifier: Apache-2.0
// Halves a frame that was drawn at 2×2 samples per pixel: colours averaged in linear light, disparity and coverage
// taken from the class most of the four samples have.
#pragma once

#include "client/warp/frame_image.h"

namespace farfield::client {

/// Requires: `fine` has even width and height. `frame` is resized; its statistics are left alone, except that
/// background and void pixels are counted. Runs on the calling TBB arena's threads.
void average_samples(const Frame& fine, Frame& frame);

}  // namespace farfield::client

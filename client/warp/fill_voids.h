// SPDX-License-Identifier: Apache-2.0
// Decides what stands where nothing landed: a void, shown as its farthest neighbours' surface, or the sky.
//
// A pixel is a void if the leaf set says that the background cannot be seen in its direction.
// The farthest neighbour, because what a void hides was hidden behind something nearer when the views were made.
#pragma once

#include <cstdint>

#include "client/warp/frame_image.h"
#include "common/impostor/direction_mask.h"

namespace farfield::client {

/// Changes pixels of class kBackground; looks for neighbours within `radius` pixels first. Returns: how many became voids. Runs on the calling TBB arena's threads.
std::uint64_t fill_voids(Frame& frame, const SkyTest& sky, int radius);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// Decides what stands where nothing landed: a void, shown as its farthest neighbours' surface, or the sky.
//
// A pixel is a void if surfaces enclose it, within `radius` pixels on opposite sides (eight directions, not both near
// geometry: between two near bars the sky may well show), or if the leaf set says that the background cannot be seen.
// The farthest neighbour, because what a void hides was hidden behind something nearer when the views were made.
#pragma once

#include <cstdint>

#include "client/warp/frame_image.h"

namespace farfield::client {

/// Changes pixels of class kBackground. Returns: how many became voids. Runs on the calling TBB arena's threads.
std::uint64_t fill_voids(Frame& frame, bool background_visible, int radius);

}  // namespace farfield::client

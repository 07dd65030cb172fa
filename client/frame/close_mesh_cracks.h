// SPDX-License-Identifier: Apache-2.0
// Closes cracks one pixel wide between depth meshes. Meshes tile a surface, so only pixels nothing was drawn on can be
// cracks (splats leave others, client/warp/close_cracks.h): those between two impostor pixels of similar disparity on
// opposite sides.
#pragma once

#include <cstdint>

#include "client/warp/frame_image.h"

namespace farfield::client {

/// Changes pixels of class kBackground. Returns: how many were closed. O(pixels).
std::uint64_t close_mesh_cracks(Frame& frame);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// Two frames of one eye as one, while one leaf set gives way to another.
#pragma once

#include "client/warp/frame_image.h"

namespace farfield::client {

/// Makes `newest` the mixture with `newest_share`, 0 … 1, of its colour and the rest of `former`'s. Where one of them only
/// guessed what is there (Coverage::kVoidFilled) and the other knows, the other's pixel is taken whole; depth and class are
/// otherwise the newest's. Void pixels are counted anew. What lies between two levels of 8 bits is dithered in a fixed pattern of
/// 8×8 pixels: rounded, whole surfaces that differ by one level would change in the same frame. Requires: both of one size.
/// O(pixels).
void mix_frames(const Frame& former, double newest_share, Frame& newest);

}  // namespace farfield::client

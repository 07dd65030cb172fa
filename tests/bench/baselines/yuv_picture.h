// SPDX-License-Identifier: Apache-2.0
// RGB as video codes it: BT.709 luma and chroma, 8 bits, limited range, chroma at full or half resolution. Chroma samples
// lie in the middle of their 2×2 pixels. Rounded to nearest throughout; libswscale's 4:2:0 comes back up to 0.6 codes
// brighter on average, which FLIP shows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace farfield::bench {

/// One plane of a picture in someone else's memory.
template <class Byte>
struct Plane {
  Byte* rows = nullptr;
  int stride = 0;  // bytes
};

/// `chroma_step`: 1, or 2 for half resolution. Requires: even sizes for 2; planes of (width / step) × (height / step).
void rgb_to_yuv(std::span<const std::uint8_t> rgb, int width, int height, int chroma_step, const Plane<std::uint8_t> (&planes)[3]);
/// Chroma is interpolated linearly. Returns: rows of packed RGB.
std::vector<std::uint8_t> yuv_to_rgb(const Plane<const std::uint8_t> (&planes)[3], int width, int height, int chroma_step);

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// The 64-bit word a pixel holds while splats are scattered: the larger word wins.
//
//   63 … 47  disparity, upper 17 bits of its float (sign left out): steps of 1/512
//   46 … 39  closeness, 1 … 255: how near the splat's centre is to the pixel's; decides between samples of a surface
//   38 … 25  disparity, lower 14 bits
//   24       1: near geometry
//   23 …  0  colour 0xBBGGRR
//
// Non-negative floats order like their bits. 0 means that nothing landed; closeness is never 0, so even black at
// infinity is more than that. Without the closeness, overlapping splats of one surface would be chosen by the noise
// of their disparities, and the image would move by up to a pixel.
#pragma once

#include <bit>
#include <cstdint>

namespace farfield::client {

inline constexpr std::uint64_t kNoSplat = 0;
inline constexpr int kClosenessShift = 39;
inline constexpr std::uint32_t kClosest = 255;
/// Penalty per squared pixel between the centres, along each axis, and its limit: two limits leave closeness 1.
inline constexpr float kPenaltyPerSquarePixel = 64.0f;
inline constexpr std::uint32_t kPenaltyLimit = 127;

/// The upper and lower half of a key with closeness kClosest - penalty. Requires: disparity is 0 or more.
inline std::uint32_t key_high(std::uint32_t disparity_bits, std::uint32_t penalty) {
  return ((disparity_bits >> 14) << 15) | ((kClosest - penalty) << 7) | ((disparity_bits & 0x3fff) >> 7);
}
inline std::uint32_t key_low(std::uint32_t disparity_bits, std::uint32_t colour) {
  return (disparity_bits << 25) | (colour & 0xffffff);
}
inline std::uint64_t make_key(std::uint32_t high, std::uint32_t low) {
  return static_cast<std::uint64_t>(high) << 32 | low;
}
inline std::uint64_t near_key(float disparity, std::uint32_t colour) {
  const auto bits = std::bit_cast<std::uint32_t>(disparity);
  return make_key(key_high(bits, 0), key_low(bits, colour) | 1u << 24);
}

inline float key_disparity(std::uint64_t key) {
  const auto upper = static_cast<std::uint32_t>(key >> 47), lower = static_cast<std::uint32_t>(key >> 25) & 0x3fff;
  return std::bit_cast<float>(upper << 14 | lower);
}
inline bool key_is_near(std::uint64_t key) { return key >> 24 & 1; }
inline std::uint32_t key_colour(std::uint64_t key) { return static_cast<std::uint32_t>(key) & 0xffffff; }

}  // namespace farfield::client

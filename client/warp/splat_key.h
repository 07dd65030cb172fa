// SPDX-License-Identifier: Apache-2.0
// The 64-bit word a pixel holds while splats are scattered: the larger word wins.
//
//   63 … 33  disparity: its float, without the sign
//   32       1
//   24       1: near geometry
//   23 …  0  colour 0xBBGGRR
//
// Non-negative floats order like their bits. 0 means that nothing landed; even black at infinity is more than that.
#pragma once

#include <bit>
#include <cstdint>

namespace farfield::client {

inline constexpr std::uint64_t kNoSplat = 0;

/// The upper half. Requires: disparity is 0 or more.
inline std::uint32_t key_high(float disparity) { return std::bit_cast<std::uint32_t>(disparity) << 1 | 1; }
inline std::uint64_t make_key(std::uint32_t high, std::uint32_t colour) {
  return static_cast<std::uint64_t>(high) << 32 | colour;
}
inline std::uint64_t near_key(float disparity, std::uint32_t colour) {
  return make_key(key_high(disparity), (colour & 0xffffff) | 1u << 24);
}

inline float key_disparity(std::uint64_t key) { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 33)); }
inline bool key_is_near(std::uint64_t key) { return key >> 24 & 1; }
inline std::uint32_t key_colour(std::uint64_t key) { return static_cast<std::uint32_t>(key) & 0xffffff; }

}  // namespace farfield::client

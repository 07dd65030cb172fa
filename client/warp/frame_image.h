// SPDX-License-Identifier: Apache-2.0
// A finished frame, and what each of its pixels came from: what every renderer of impostors hands out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace farfield::client {

/// Where a pixel's colour came from. The benchmark compares these classes with truth.
enum class Coverage : std::uint8_t {
  kNear,         // near geometry
  kImpostor,     // a mesh or splat landed here
  kCrackClosed,  // a one-pixel crack in a surface, closed from both sides
  kVoidFilled,   // nothing landed here although a surface was to be expected: its farthest neighbours' surface
  kBackground,   // nothing, and nothing to be expected: the sky
};

struct FrameStatistics {
  std::uint64_t samples_drawn = 0;    // splats projected, once each (or vertices, for meshes)
  std::uint64_t triangles_drawn = 0;  // of impostor meshes
  std::uint64_t tiles_drawn = 0;      // not culled
  std::uint64_t crack_pixels = 0;
  std::uint64_t void_pixels = 0;      // Coverage::kVoidFilled
  std::uint64_t background_pixels = 0;
};

/// Arrays are [row][column], top row first.
struct Frame {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;      // sRGB; alpha is always 255
  std::vector<float> disparity;        // 1/(z along the camera's axis), per metre; 0: infinitely far
  std::vector<Coverage> coverage;
  FrameStatistics statistics;

  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
};

}  // namespace farfield::client

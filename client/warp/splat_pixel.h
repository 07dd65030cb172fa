// SPDX-License-Identifier: Apache-2.0
// One pixel of one splat: whether its centre lies in the sample's cell, and what the surface shows there. Written
// without branches, so that loops over it become SIMD code.
#pragma once

#include <cmath>

#include "client/warp/project_row.h"
#include "client/warp/splat_key.h"

namespace farfield::client {

/// All bits where the condition holds: arithmetic that no compiler turns into a branch.
inline int mask_of(bool condition) { return -static_cast<int>(condition); }
inline int select(int mask, int yes, int no) { return (yes & mask) | (no & ~mask); }
inline std::uint32_t select(int mask, std::uint32_t yes, std::uint32_t no) {
  const auto m = static_cast<std::uint32_t>(mask);
  return (yes & m) | (no & ~m);
}
/// Not a number gives `low`.
inline float clamped(float value, float low, float high) {
  const float above = value > low ? value : low;
  return above < high ? above : high;
}

/// One side's reach in samples.
inline float reach_of(std::uint32_t packed, int shift) {
  return static_cast<float>(static_cast<int>(packed >> shift & 15)) * (1.0f / 16.0f) + kRoundingMargin;
}

/// Own colour towards that of the neighbours along s and t, by weights in 1/256, at most 128 each: all three channels
/// stay in range without clamping, two of them in one word.
inline std::uint32_t blend(std::uint32_t own, std::uint32_t along_s, std::uint32_t along_t, std::uint32_t weight_s,
                           std::uint32_t weight_t) {
  const std::uint32_t weight = 256 - weight_s - weight_t;
  const std::uint32_t red_blue = (own & 0xff00ff) * weight + (along_s & 0xff00ff) * weight_s +
                                 (along_t & 0xff00ff) * weight_t + 0x800080;
  const std::uint32_t green = (own >> 8 & 0xff) * weight + (along_s >> 8 & 0xff) * weight_s +
                              (along_t >> 8 & 0xff) * weight_t + 0x80;
  return (red_blue >> 8 & 0xff00ff) | (green & 0xff00);
}

/// A neighbour's weight at a distance of s samples from the sample's own centre, in 1/256.
inline std::uint32_t weight_of(float s) {
  const float scaled = 256.0f * std::fabs(s);
  return static_cast<std::uint32_t>(static_cast<int>(scaled < 128.0f ? scaled : 128.0f));
}

/// Sample i of a projected piece.
struct SplatAt {
  float x, y, s_x, s_y, t_x, t_y, disparity, disparity_s, disparity_t;
  std::uint32_t reach, colour, left, right, up, down;  // the latter five: own and neighbours' colours

  SplatAt(const ProjectedRow& row, const RowSamples& samples, int i)
      : x(row.x[i]), y(row.y[i]), s_x(row.s_x[i]), s_y(row.s_y[i]), t_x(row.t_x[i]), t_y(row.t_y[i]),
        disparity(row.disparity[i]), disparity_s(row.disparity_s[i]), disparity_t(row.disparity_t[i]),
        reach(samples.reach[i]), colour(samples.colour[i]), left(samples.colour_left[i]),
        right(samples.colour_right[i]), up(samples.colour_up[i]), down(samples.colour_down[i]) {}
};

struct SplatPixel {
  int is_inside = 0;  // a mask
  std::uint32_t high = 0, low = 0;
};

inline SplatPixel splat_pixel(const SplatAt& splat, int column, int line) {
  const float dx = static_cast<float>(column) - splat.x, dy = static_cast<float>(line) - splat.y;
  const float s = splat.s_x * dx + splat.s_y * dy, t = splat.t_x * dx + splat.t_y * dy;
  const std::uint32_t reach = splat.reach;
  SplatPixel pixel;
  pixel.is_inside = mask_of(s >= -reach_of(reach, 0)) & mask_of(s <= reach_of(reach, 4)) &
                    mask_of(t >= -reach_of(reach, 8)) & mask_of(t <= reach_of(reach, 12));
  const float nearness = 1.0f - kDistancePenalty * (s * s + t * t);
  const float disparity = (splat.disparity + s * splat.disparity_s + t * splat.disparity_t) * nearness;
  pixel.high = key_high(disparity > 0.0f ? disparity : 0.0f);

  const int is_right = mask_of(s > 0.0f), is_down = mask_of(t > 0.0f);
  const std::uint32_t side = select(is_right, splat.right, splat.left);
  const std::uint32_t side_reach = select(is_right, reach >> 4, reach) & 15;
  const std::uint32_t along_s = select(mask_of(side_reach == kReachConnected), side, splat.colour);
  const std::uint32_t along_t = select(is_down, splat.down, splat.up);
  pixel.low = blend(splat.colour, along_s, along_t, weight_of(s), weight_of(t));
  return pixel;
}

}  // namespace farfield::client

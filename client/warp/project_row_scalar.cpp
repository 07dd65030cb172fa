// SPDX-License-Identifier: Apache-2.0
// The reference: one sample after another, each step of tile_projection.h in words, the same roundings in order.
#include <algorithm>
#include <bit>
#include <cmath>

#include "client/warp/project_row.h"
#include "client/warp/splat_key.h"
#include "client/warp/tile_projection.h"

namespace farfield::client {
namespace {

struct Landing {
  float x = 0, y = 0, w = 0;  // pixels from the frame's corner; behind the eye where w is not positive
  std::uint32_t disparity_bits = 0;
};

Landing land(const RowProjection& row, int i, float disparity) {
  const auto component = [&](int k) {
    return row.start[k] + static_cast<float>(row.first + i) * row.step[k] + disparity * row.per_disparity[k];
  };
  Landing landing;
  landing.w = component(2);
  const float inverse = 1.0f / landing.w;
  landing.x = component(0) * inverse;
  landing.y = component(1) * inverse;
  const float eye_disparity = disparity * row.disparity_scale * inverse;
  landing.disparity_bits = std::bit_cast<std::uint32_t>(eye_disparity > 0.0f ? eye_disparity : 0.0f);
  return landing;
}

std::uint32_t distance_penalty(float distance) {
  return static_cast<std::uint32_t>(
      std::min(kPenaltyPerSquarePixel * (distance * distance), static_cast<float>(kPenaltyLimit)));
}

}  // namespace

void project_points_scalar(const RowProjection& row, const PixelWindow& window, const float* disparity,
                           const std::uint32_t* colour, int count, ProjectedPoints& out) {
  for (int i = 0; i < count; ++i) {
    const Landing landing = land(row, i, disparity[i]);
    out.offset[i] = -1;
    out.high[i] = key_high(landing.disparity_bits, 0);
    out.low[i] = key_low(landing.disparity_bits, colour[i]);
    if (!(landing.w > 0)) continue;
    if (!(landing.x >= 0 && landing.x < static_cast<float>(window.width))) continue;
    if (!(landing.y >= static_cast<float>(window.top) && landing.y < static_cast<float>(window.bottom))) continue;
    const int column = static_cast<int>(landing.x), line = static_cast<int>(landing.y);
    const std::uint32_t penalty = distance_penalty(landing.x - (static_cast<float>(column) + 0.5f)) +
                                  distance_penalty(landing.y - (static_cast<float>(line) + 0.5f));
    out.offset[i] = line * window.width + column;
    out.high[i] = key_high(landing.disparity_bits, penalty);
  }
}

void project_boxes_scalar(const RowProjection& row, const PixelWindow& window, const float* disparity,
                          const std::uint32_t* colour, int count, ProjectedBoxes& out) {
  for (int i = 0; i < count; ++i) {
    const Landing landing = land(row, i, disparity[i]);
    out.high[i] = key_high(landing.disparity_bits, 0);
    out.low[i] = key_low(landing.disparity_bits, colour[i]);
    out.top[i] = window.top;
    out.bottom[i] = window.top - 1;
    const float x = landing.x - 0.5f, y = landing.y - 0.5f;  // in pixel centres
    const float margin = kMaxFootprint;
    if (!(landing.w > 0)) continue;
    if (!(x >= -margin && x < static_cast<float>(window.width) + margin)) continue;
    if (!(y >= static_cast<float>(window.top) - margin && y < static_cast<float>(window.bottom) + margin)) continue;

    const float inverse = 1.0f / landing.w;
    const auto half = [&](float reach) {
      return 0.5f * std::clamp(reach * inverse + kRoundingMargin, 1.0f, static_cast<float>(kMaxFootprint));
    };
    const float half_width = half(row.reach_x), half_height = half(row.reach_y);
    out.column[i] = x;
    out.row[i] = y;
    out.left[i] = std::max(static_cast<int>(std::ceil(x - half_width)), 0);
    out.right[i] = std::min(static_cast<int>(std::ceil(x + half_width)) - 1, window.width - 1);
    out.top[i] = std::max(static_cast<int>(std::ceil(y - half_height)), window.top);
    out.bottom[i] = std::min(static_cast<int>(std::ceil(y + half_height)) - 1, window.bottom - 1);
    out.left_penalty[i] = distance_penalty(static_cast<float>(out.left[i]) - x);
    out.right_penalty[i] = distance_penalty(static_cast<float>(out.right[i]) - x);
    out.top_penalty[i] = distance_penalty(static_cast<float>(out.top[i]) - y);
    out.bottom_penalty[i] = distance_penalty(static_cast<float>(out.bottom[i]) - y);
    if (out.bottom[i] < out.top[i]) out.bottom[i] = out.top[i] - 1;
  }
}

}  // namespace farfield::client

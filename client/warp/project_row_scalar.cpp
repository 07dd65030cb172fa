// SPDX-License-Identifier: Apache-2.0
// The reference: one sample after another, each step of tile_projection.h and project_row.h in words, the same
// roundings in order.
#include <algorithm>
#include <cmath>

#include "client/warp/project_row.h"
#include "client/warp/splat_key.h"

namespace farfield::client {
namespace {

/// How far the surface reaches from the sample, in samples.
struct Reach {
  float left, right, up, down;
  explicit Reach(std::uint16_t packed) {
    const auto side = [&](int shift) { return static_cast<float>(packed >> shift & 15) / 16.0f + kRoundingMargin; };
    left = side(0), right = side(4), up = side(8), down = side(12);
  }
};

/// The first and last pixel centre in [centre + low, centre + high], no farther than kMaxReach from it.
struct Span {
  int first, last;
  Span(float centre, float low, float high, int begin, int end) {
    first = std::max(static_cast<int>(std::ceil(centre + within_reach(low))), begin);
    last = std::min(static_cast<int>(std::floor(centre + within_reach(high))), end - 1);
  }
  /// Not a number, where slopes overflow, counts as the lower limit.
  static float within_reach(float offset) {
    const float limit = static_cast<float>(kMaxReach);
    return offset > -limit ? std::min(offset, limit) : -limit;
  }
};

std::uint32_t mix(std::uint32_t own, std::uint32_t along_s, std::uint32_t along_t, int weight_s, int weight_t) {
  std::uint32_t mixed = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    const auto channel = [&](std::uint32_t colour) { return static_cast<int>(colour >> shift & 255); };
    const int sum = (256 - weight_s - weight_t) * channel(own) + weight_s * channel(along_s) + weight_t * channel(along_t);
    mixed |= static_cast<std::uint32_t>((sum + 128) / 256) << shift;
  }
  return mixed;
}

}  // namespace

void project_row_scalar(const RowProjection& p, const PixelWindow& window, const RowSamples& samples,
                        ProjectedRow& out) {
  out.second_column = out.second_line = 0;
  for (int i = 0; i < samples.count; ++i) {
    out.left[i] = out.right[i] = 0;
    out.top[i] = window.top, out.bottom[i] = window.top - 1;
    out.wide[i] = -1;
    const float d = samples.disparity[i];
    const float w = samples.infinity_w[i] + d * p.per_disparity[2];
    if (!(w > 0)) continue;
    const float inverse = 1.0f / w;
    const float screen_x = (samples.infinity_x[i] + d * p.per_disparity[0]) * inverse;
    const float screen_y = (samples.infinity_y[i] + d * p.per_disparity[1]) * inverse;
    const float x = screen_x - 0.5f, y = screen_y - 0.5f;  // in pixel centres
    const float margin = kMaxReach;
    if (!(x > -margin && x < static_cast<float>(window.width) + margin)) continue;
    if (!(y > static_cast<float>(window.top) - margin && y < static_cast<float>(window.bottom) + margin)) continue;

    const float slope_u = samples.slope_u[i], slope_v = samples.slope_v[i];
    const float w_u = p.step_u[2] + slope_u * p.per_disparity[2], w_v = p.step_v[2] + slope_v * p.per_disparity[2];
    const auto derivative = [&](const float* step, float slope, int k, float screen, float along_w) {
      return (step[k] + slope * p.per_disparity[k] - screen * along_w) * inverse;
    };
    const float x_u = derivative(p.step_u, slope_u, 0, screen_x, w_u), y_u = derivative(p.step_u, slope_u, 1, screen_y, w_u);
    const float x_v = derivative(p.step_v, slope_v, 0, screen_x, w_v), y_v = derivative(p.step_v, slope_v, 1, screen_y, w_v);

    out.x[i] = x;
    out.y[i] = y;
    const float area = x_u * y_v - y_u * x_v, per_area = 1.0f / area;
    out.s_x[i] = y_v * per_area, out.s_y[i] = -x_v * per_area;
    out.t_x[i] = -y_u * per_area, out.t_y[i] = x_u * per_area;
    const float eye = d * p.disparity_scale * inverse;
    const float footprint = std::clamp(std::abs(area) - 1.0f, 0.0f, kLargestFootprint);
    out.disparity[i] = eye * (1.0f - kFootprintPenalty * footprint);
    out.disparity_s[i] = (slope_u * p.disparity_scale - eye * w_u) * inverse;
    out.disparity_t[i] = (slope_v * p.disparity_scale - eye * w_v) * inverse;

    const Reach reach(samples.reach[i]);
    const auto span = [&](float centre, float along_u, float along_v, int begin, int end) {
      const float middle = 0.5f * (reach.right - reach.left) * along_u + 0.5f * (reach.down - reach.up) * along_v;
      const float half = 0.5f * (reach.right + reach.left) * std::abs(along_u) +
                         0.5f * (reach.down + reach.up) * std::abs(along_v);
      return Span(centre, middle - half, middle + half, begin, end);
    };
    const Span columns = span(x, x_u, x_v, 0, window.width), lines = span(y, y_u, y_v, window.top, window.bottom);
    out.left[i] = columns.first, out.right[i] = columns.last;
    out.top[i] = lines.first, out.bottom[i] = lines.first - 1;
    if (columns.last < columns.first || lines.last < lines.first) continue;
    out.bottom[i] = lines.last;
    if (columns.last > columns.first) out.second_column = -1;
    if (lines.last > lines.first) out.second_line = -1;
    if (columns.last - columns.first >= kNarrow || lines.last - lines.first >= kNarrow) out.wide[i] = 0;
  }
}

void sample_pixels_scalar(const ProjectedRow& row, const RowSamples& samples, int width, int dx, int dy,
                          SplatPixels& out) {
  for (int i = 0; i < samples.count; ++i) {
    out.offset[i] = -1;
    out.high[i] = out.low[i] = 0;
    const int column = row.left[i] + dx, line = row.top[i] + dy;
    if (column > row.right[i] || line > row.bottom[i]) continue;
    const float from_x = static_cast<float>(column) - row.x[i], from_y = static_cast<float>(line) - row.y[i];
    const float s = row.s_x[i] * from_x + row.s_y[i] * from_y, t = row.t_x[i] * from_x + row.t_y[i] * from_y;
    const Reach reach(samples.reach[i]);
    if (!(s >= -reach.left && s <= reach.right && t >= -reach.up && t <= reach.down)) continue;

    const float nearness = 1.0f - kDistancePenalty * (s * s + t * t);
    const float disparity = (row.disparity[i] + s * row.disparity_s[i] + t * row.disparity_t[i]) * nearness;
    const bool is_right = s > 0, is_down = t > 0;
    const bool has_side = (samples.reach[i] >> (is_right ? 4 : 0) & 15) == kReachConnected;
    const std::uint32_t own = samples.colour[i];
    const std::uint32_t along_s = !has_side ? own : is_right ? samples.colour_right[i] : samples.colour_left[i];
    const std::uint32_t along_t = is_down ? samples.colour_down[i] : samples.colour_up[i];
    const auto weight = [](float distance) { return static_cast<int>(256.0f * std::min(std::abs(distance), 0.5f)); };
    out.offset[i] = line * width + column;
    out.high[i] = key_high(disparity > 0 ? disparity : 0.0f);  // not a number: infinitely far
    out.low[i] = mix(own, along_s, along_t, weight(s), weight(t));
  }
}

}  // namespace farfield::client

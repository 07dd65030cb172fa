// SPDX-License-Identifier: Apache-2.0
// The vectorised projection: no branches, no calls, conditions as masks, so that the compiler turns each loop into
// straight SIMD code.
#include "client/warp/project_row.h"

#include <cmath>

#include "client/warp/splat_pixel.h"

namespace farfield::client {
namespace {

inline int smaller(int a, int b) { return a < b ? a : b; }
inline int larger(int a, int b) { return a > b ? a : b; }
inline int ceiling(float value) {
  const int towards_zero = static_cast<int>(value);
  return towards_zero - mask_of(value > static_cast<float>(towards_zero));
}
inline int floored(float value) {
  const int towards_zero = static_cast<int>(value);
  return towards_zero + mask_of(value < static_cast<float>(towards_zero));
}

}  // namespace

void project_row(const RowProjection& projection, const PixelWindow& window, const RowSamples& samples,
                 ProjectedRow& out) {
  const RowProjection p = projection;
  const int count = samples.count;
  const float* __restrict disparity = samples.disparity;
  const float* __restrict slopes_u = samples.slope_u;
  const float* __restrict slopes_v = samples.slope_v;
  const std::uint16_t* __restrict reaches = samples.reach;
  const float* __restrict infinity_x = samples.infinity_x.data();
  const float* __restrict infinity_y = samples.infinity_y.data();
  const float* __restrict infinity_w = samples.infinity_w.data();
  const float limit = static_cast<float>(kMaxReach);
  const float x_end = static_cast<float>(window.width) + limit;
  const float y_begin = static_cast<float>(window.top) - limit, y_end = static_cast<float>(window.bottom) + limit;
  const int last_column = window.width - 1, first_row = window.top, last_row = window.bottom - 1;
  int second_column = 0, second_line = 0;
#pragma GCC ivdep  // the arrays of one result do not overlap
  for (int i = 0; i < count; ++i) {
    const float d = disparity[i];
    const float slope_u = slopes_u[i], slope_v = slopes_v[i];
    const float w = infinity_w[i] + d * p.per_disparity[2];
    const float inverse = 1.0f / w;
    const float screen_x = (infinity_x[i] + d * p.per_disparity[0]) * inverse;
    const float screen_y = (infinity_y[i] + d * p.per_disparity[1]) * inverse;
    // Derivatives of (X/w, Y/w) and of the eye disparity along the row and the column of the face.
    const float w_u = p.step_u[2] + slope_u * p.per_disparity[2], w_v = p.step_v[2] + slope_v * p.per_disparity[2];
    const float x_u = (p.step_u[0] + slope_u * p.per_disparity[0] - screen_x * w_u) * inverse;
    const float y_u = (p.step_u[1] + slope_u * p.per_disparity[1] - screen_y * w_u) * inverse;
    const float x_v = (p.step_v[0] + slope_v * p.per_disparity[0] - screen_x * w_v) * inverse;
    const float y_v = (p.step_v[1] + slope_v * p.per_disparity[1] - screen_y * w_v) * inverse;
    const float eye = d * p.disparity_scale * inverse;
    const float area = x_u * y_v - y_u * x_v, per_area = 1.0f / area;
    const float footprint = clamped(std::fabs(area) - 1.0f, 0.0f, kLargestFootprint);
    const float centre_x = screen_x - 0.5f, centre_y = screen_y - 0.5f;
    const float x = clamped(centre_x, -limit, x_end), y = clamped(centre_y, y_begin, y_end);
    const int inside = mask_of(w > 0.0f) & mask_of(centre_x > -limit) & mask_of(centre_x < x_end) &
                       mask_of(centre_y > y_begin) & mask_of(centre_y < y_end);
    const std::uint32_t reach = reaches[i];
    const float to_left = reach_of(reach, 0), to_right = reach_of(reach, 4), to_up = reach_of(reach, 8),
                to_down = reach_of(reach, 12);
    // The parallelogram's middle relative to the sample, and half its extent.
    const float middle_u = 0.5f * (to_right - to_left), middle_v = 0.5f * (to_down - to_up);
    const float half_u = 0.5f * (to_right + to_left), half_v = 0.5f * (to_down + to_up);
    const float middle_x = middle_u * x_u + middle_v * x_v, half_x = half_u * std::fabs(x_u) + half_v * std::fabs(x_v);
    const float middle_y = middle_u * y_u + middle_v * y_v, half_y = half_u * std::fabs(y_u) + half_v * std::fabs(y_v);

    out.x[i] = x;
    out.y[i] = y;
    out.s_x[i] = y_v * per_area;
    out.s_y[i] = -x_v * per_area;
    out.t_x[i] = -y_u * per_area;
    out.t_y[i] = x_u * per_area;
    out.disparity[i] = eye * (1.0f - kFootprintPenalty * footprint);
    out.disparity_s[i] = (slope_u * p.disparity_scale - eye * w_u) * inverse;
    out.disparity_t[i] = (slope_v * p.disparity_scale - eye * w_v) * inverse;
    const int left = larger(ceiling(x + clamped(middle_x - half_x, -limit, limit)), 0);
    const int right = smaller(floored(x + clamped(middle_x + half_x, -limit, limit)), last_column);
    const int top = larger(ceiling(y + clamped(middle_y - half_y, -limit, limit)), first_row);
    const int bottom = smaller(floored(y + clamped(middle_y + half_y, -limit, limit)), last_row);
    out.left[i] = left;
    out.right[i] = right;
    out.top[i] = top;
    const int lands = inside & mask_of(right >= left) & mask_of(bottom >= top);
    out.bottom[i] = select(lands, bottom, top - 1);
    out.wide[i] = ~(lands & (mask_of(right >= left + kNarrow) | mask_of(bottom >= top + kNarrow)));
    second_column |= lands & mask_of(right > left);
    second_line |= lands & mask_of(bottom > top);
  }
  out.second_column = second_column, out.second_line = second_line;
}

void sample_pixels(const ProjectedRow& row, const RowSamples& samples, int width, int dx, int dy, SplatPixels& out) {
  const int count = samples.count;
#pragma GCC ivdep  // the arrays of one result do not overlap
  for (int i = 0; i < count; ++i) {
    const int column = row.left[i] + dx, line = row.top[i] + dy;
    const SplatPixel pixel = splat_pixel(SplatAt(row, samples, i), column, line);
    const int inside = pixel.is_inside & mask_of(column <= row.right[i]) & mask_of(line <= row.bottom[i]);
    out.offset[i] = select(inside, line * width + column, -1);
    out.high[i] = pixel.high;
    out.low[i] = pixel.low;
  }
}

}  // namespace farfield::client

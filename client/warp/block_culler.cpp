// SPDX-License-Identifier: Apache-2.0
#include "client/warp/block_culler.h"

#include <cmath>
#include <limits>

#include "client/warp/hidden_pixels.h"
#include "client/warp/splat_key.h"
#include "client/warp/splat_pixel.h"

namespace farfield::client {
namespace {

constexpr int kColumns = SplatBlocks::kColumns;
/// What float arithmetic may put X, Y or w off by, here and in the projection of the samples together, as a share of the
/// sum of their terms' sizes: 16 roundings of 2⁻²⁴.
constexpr float kRounding = 0x1p-20f;

/// One component of a tile's projection, in float.
struct Component {
  float origin, per_u, per_v, per_disparity, rounding;
  Component(const TileProjection& p, const Splats& splats, int k)
      : origin(static_cast<float>(p.origin[k])), per_u(static_cast<float>(p.per_u[k])),
        per_v(static_cast<float>(p.per_v[k])), per_disparity(static_cast<float>(p.per_disparity[k])),
        // Faces reach a little beyond |u| = |v| = 1, slopes a little beyond the tile's disparities.
        rounding(kRounding * (std::fabs(origin) + 2 * std::fabs(per_u) + 2 * std::fabs(per_v) +
                              2 * splats.max_disparity * std::fabs(per_disparity))) {}
};

/// A row of squares: the pixels each can reach within the window (none: right < left or bottom < top), and the largest
/// eye disparity it can have there.
struct RowOfBlocks {
  alignas(64) std::array<std::int32_t, kColumns> left, right, top, bottom;
  alignas(64) std::array<float, kColumns> nearest;
};

inline float smaller(float a, float b) { return a < b ? a : b; }
inline float larger(float a, float b) { return a > b ? a : b; }

class BlockProjection {
 public:
  BlockProjection(const TileProjection& projection, const Splats& splats, const PixelWindow& window)
      : splats_(splats), window_(window), x_(projection, splats, 0), y_(projection, splats, 1), w_(projection, splats, 2),
        disparity_scale_(static_cast<float>(projection.disparity_scale)) {}

  /// A splat's pixels and disparities follow from first derivatives at its sample. Where a point of the surface truly is
  /// at f, they put it at f₀ + (f − f₀)·w/w₀: the true range grows by its extent times (w_high/w_low − 1).
  void project(int row, RowOfBlocks& out) const {
    const Component x = x_, y = y_, w = w_;
    const float* __restrict lowest = &splats_.blocks.lowest[static_cast<std::size_t>(row) * kColumns];
    const float* __restrict highest = &splats_.blocks.highest[static_cast<std::size_t>(row) * kColumns];
    const float pitch = splats_.pitch, edge = static_cast<float>(splats_.blocks.edge);
    // Splats reach less than a sample beyond their own.
    const float u_first = splats_.u_min - pitch, u_length = (edge + 1) * pitch;
    const float v_low = splats_.v_min + (edge * static_cast<float>(row) - 1) * pitch, v_high = v_low + u_length;
    const float window_width = static_cast<float>(window_.width), scale = disparity_scale_;
    const float window_top = static_cast<float>(window_.top), window_bottom = static_cast<float>(window_.bottom);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
#pragma GCC ivdep  // the arrays of one result do not overlap
    for (int c = 0; c < kColumns; ++c) {
      const float u_low = u_first + static_cast<float>(c) * edge * pitch, u_high = u_low + u_length;
      const float d_low = lowest[c], d_high = highest[c];
      float x_low = kInfinity, x_high = -kInfinity, y_low = kInfinity, y_high = -kInfinity;
      float w_low = kInfinity, w_high = -kInfinity, eye_low = kInfinity, eye_high = -kInfinity;
#pragma GCC unroll 8
      for (int corner = 0; corner < 8; ++corner) {
        const float u = corner & 1 ? u_high : u_low, v = corner & 2 ? v_high : v_low, d = corner & 4 ? d_high : d_low;
        const float at_w = w.origin + u * w.per_u + v * w.per_v + d * w.per_disparity;
        const float inverse = 1.0f / at_w;
        const float at_x = (x.origin + u * x.per_u + v * x.per_v + d * x.per_disparity) * inverse;
        const float at_y = (y.origin + u * y.per_u + v * y.per_v + d * y.per_disparity) * inverse;
        const float eye = d * scale * inverse;
        x_low = smaller(x_low, at_x), x_high = larger(x_high, at_x);
        y_low = smaller(y_low, at_y), y_high = larger(y_high, at_y);
        w_low = smaller(w_low, at_w), w_high = larger(w_high, at_w);
        eye_low = smaller(eye_low, eye), eye_high = larger(eye_high, eye);
      }
      const int is_empty = mask_of(d_low > d_high) | mask_of(w_high < -w.rounding);
      // Close to the eye's plane nothing is known but that some of it may be in front.
      const int is_near = ~mask_of(w_low > 8 * w.rounding);
      const float stretch = w_high / w_low - 1, off = 1.0f / w_low;
      const float off_w = w.rounding * off;
      const float grow_x = stretch * (x_high - x_low) + (x.rounding + w.rounding * window_width) * off + kRoundingMargin;
      const float grow_y = stretch * (y_high - y_low) + (y.rounding + w.rounding * window_bottom) * off + kRoundingMargin;
      // From pixel coordinates to pixels whose centres lie in between; clamped first: they may be far outside.
      const int left = static_cast<int>(clamped(x_low - grow_x - 0.5f, 0.0f, window_width));
      const int right = static_cast<int>(clamped(x_high + grow_x + 0.5f, 0.0f, window_width)) - 1;
      const int top = static_cast<int>(clamped(y_low - grow_y - 0.5f, window_top, window_bottom));
      const int bottom = static_cast<int>(clamped(y_high + grow_y + 0.5f, window_top, window_bottom)) - 1;
      const float nearest = (eye_high + stretch * (eye_high - eye_low)) * (1 + 4 * off_w);
      out.left[c] = select(is_near, 0, left);
      out.right[c] = select(is_empty, -1, select(is_near, window_.width - 1, right));
      out.top[c] = select(is_near, window_.top, top);
      out.bottom[c] = select(is_near, window_.bottom - 1, bottom);
      out.nearest[c] = is_near ? kInfinity : nearest;
    }
  }

 private:
  const Splats& splats_;
  const PixelWindow window_;
  const Component x_, y_, w_;
  const float disparity_scale_;
};

}  // namespace

VisibleBlocks find_visible_blocks(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                  const std::uint64_t* keys) {
  VisibleBlocks visible{};
  const BlockProjection blocks(projection, splats, window);
  RowOfBlocks row;
  for (int j = 0; j < splats.blocks.rows; ++j) {
    blocks.project(j, row);
    for (int c = 0; c < kColumns; ++c) {
      if (row.right[c] < row.left[c] || row.bottom[c] < row.top[c]) continue;
      const PixelRectangle pixels{row.left[c], row.right[c], row.top[c], row.bottom[c]};
      if (are_hidden(pixels, row.nearest[c], window.width, keys)) continue;
      visible[j] |= 1u << c;
    }
  }
  return visible;
}

}  // namespace farfield::client

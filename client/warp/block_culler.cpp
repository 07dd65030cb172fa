// SPDX-License-Identifier: Apache-2.0
#include "client/warp/block_culler.h"

#include <algorithm>
#include <bit>
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

/// Ranges of tangent coordinates and disparity.
struct Boxes {
  alignas(64) std::array<float, kColumns> u_low, u_high, v_low, v_high, d_low, d_high;
};

/// The pixels that splats in each box can reach within the window (none: right < left or bottom < top), and the largest
/// eye disparity they can have there.
struct Reaches {
  alignas(64) std::array<std::int32_t, kColumns> left, right, top, bottom;
  alignas(64) std::array<float, kColumns> nearest;

  /// Bit k: box k can reach some pixel.
  std::uint32_t landing() const {
    std::uint32_t bits = 0;
    for (int k = 0; k < kColumns; ++k)
      bits |= static_cast<std::uint32_t>(mask_of(left[k] <= right[k]) & mask_of(top[k] <= bottom[k])) & 1u << k;
    return bits;
  }
  PixelRectangle pixels(std::size_t k) const { return {left[k], right[k], top[k], bottom[k]}; }
};

/// Calls f(k) for every bit, the lowest first.
template <class F>
void for_each_bit(std::uint32_t bits, F&& f) {
  for (; bits != 0; bits &= bits - 1) f(static_cast<std::size_t>(std::countr_zero(bits)));
}

inline float smaller(float a, float b) { return a < b ? a : b; }
inline float larger(float a, float b) { return a > b ? a : b; }

class BoxProjection {
 public:
  BoxProjection(const TileProjection& projection, const Splats& splats, const PixelWindow& window)
      : window_(window), x_(projection, splats, 0), y_(projection, splats, 1), w_(projection, splats, 2),
        disparity_scale_(static_cast<float>(projection.disparity_scale)) {}

  /// A splat's pixels and disparities follow from first derivatives at its sample. Where a point of the surface truly is
  /// at f, they put it at f₀ + (f − f₀)·w/w₀: the true range grows by its extent times (w_high/w_low − 1).
  void project(const Boxes& boxes, Reaches& out) const {
    const Component x = x_, y = y_, w = w_;
    const float window_width = static_cast<float>(window_.width), scale = disparity_scale_;
    const float window_top = static_cast<float>(window_.top), window_bottom = static_cast<float>(window_.bottom);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
#pragma GCC ivdep  // the arrays of one result do not overlap
    for (int c = 0; c < kColumns; ++c) {
      const float u_low = boxes.u_low[c], u_high = boxes.u_high[c], v_low = boxes.v_low[c], v_high = boxes.v_high[c];
      const float d_low = boxes.d_low[c], d_high = boxes.d_high[c];
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
  const PixelWindow window_;
  const Component x_, y_, w_;
  const float disparity_scale_;
};

/// Boxes of a tile's squares. Splats reach less than a sample beyond their own.
class TileBoxes {
 public:
  explicit TileBoxes(const Splats& splats)
      : splats_(splats), begin_u_(splats.u_min - splats.pitch), begin_v_(splats.v_min - splats.pitch),
        stride_(splats.pitch * static_cast<float>(splats.blocks.edge)), length_(stride_ + splats.pitch) {}

  void row_of_squares(int row, Boxes& out) const {
    const float v_low = begin_v_ + stride_ * static_cast<float>(row), v_high = v_low + length_;
    for (int c = 0; c < kColumns; ++c) {
      out.u_low[c] = begin_u_ + stride_ * static_cast<float>(c);
      out.u_high[c] = out.u_low[c] + length_;
      out.v_low[c] = v_low, out.v_high[c] = v_high;
    }
    set_disparities(row, out);
  }
  void whole_rows(Boxes& out) const {
    const float u_high = splats_.u_max + splats_.pitch;
    for (int j = 0; j < kColumns; ++j) {
      out.u_low[j] = begin_u_, out.u_high[j] = u_high;
      out.v_low[j] = begin_v_ + stride_ * static_cast<float>(j);
      out.v_high[j] = out.v_low[j] + length_;
    }
    set_disparities(splats_.blocks.rows, out);
  }

 private:
  void set_disparities(int row, Boxes& out) const {
    const std::size_t first = static_cast<std::size_t>(row) * kColumns;
    std::copy_n(&splats_.blocks.lowest[first], kColumns, out.d_low.begin());
    std::copy_n(&splats_.blocks.highest[first], kColumns, out.d_high.begin());
  }

  const Splats& splats_;
  const float begin_u_, begin_v_, stride_, length_;
};

}  // namespace

VisibleBlocks find_visible_blocks(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                  ShownDepths& shown) {
  VisibleBlocks visible{};
  if (splats.blocks.rows == 0) return visible;
  const BoxProjection to_window(projection, splats, window);
  const TileBoxes tile(splats);
  Boxes boxes;
  Reaches rows, squares;
  tile.whole_rows(boxes);
  to_window.project(boxes, rows);
  for_each_bit(rows.landing() & ((1u << splats.blocks.rows) - 1), [&](std::size_t j) {
    if (shown.hide(rows.pixels(j), rows.nearest[j])) return;
    tile.row_of_squares(static_cast<int>(j), boxes);
    to_window.project(boxes, squares);
    for_each_bit(squares.landing(), [&](std::size_t c) {
      if (shown.hide(squares.pixels(c), squares.nearest[c])) return;
      visible[j] |= 1u << c;
      shown.drawn(squares.pixels(c));
    });
  });
  return visible;
}

namespace {

/// Of squares whose samples (0, 0) stand in columns [first_column, last_column] and rows alike, the k-th box.
void set_box(const Splats& splats, std::size_t k, const SquareGroup& squares, Boxes& boxes) {
  constexpr int kAfter = kSquareEdge;  // one sample beyond the last
  boxes.u_low[k] = splats.tangent(squares.first_column - 1), boxes.u_high[k] = splats.tangent(squares.last_column + kAfter);
  boxes.v_low[k] = splats.tangent(squares.first_row - 1), boxes.v_high[k] = splats.tangent(squares.last_row + kAfter);
  boxes.d_low[k] = squares.lowest, boxes.d_high[k] = squares.highest;
}

std::uint32_t find_visible_boxes(const BoxProjection& to_window, const Boxes& boxes, std::size_t count, ShownDepths& shown) {
  Reaches reaches;
  to_window.project(boxes, reaches);
  std::uint32_t visible = 0;
  for_each_bit(reaches.landing() & ((1u << count) - 1), [&](std::size_t k) {
    if (!shown.hide(reaches.pixels(k), reaches.nearest[k])) visible |= 1u << k;
  });
  return visible;
}

}  // namespace

std::uint32_t find_visible_groups(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                  ShownDepths& shown, std::size_t begin, std::size_t end) {
  Boxes boxes;
  for (std::size_t k = 0; k < kColumns; ++k) set_box(splats, k, splats.pieces.groups[std::min(begin + k, end - 1)], boxes);
  return find_visible_boxes(BoxProjection(projection, splats, window), boxes, end - begin, shown);
}

std::uint32_t find_visible_squares(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                   ShownDepths& shown, std::size_t begin, std::size_t end) {
  Boxes boxes;
  for (std::size_t k = 0; k < kColumns; ++k) {
    const PieceSquare& square = splats.pieces.squares[std::min(begin + k, end - 1)];
    set_box(splats, k, {square.column, square.column, square.row, square.row, square.lowest, square.highest}, boxes);
  }
  return find_visible_boxes(BoxProjection(projection, splats, window), boxes, end - begin, shown);
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// Planes over the surfaces of a node, rounded as the disparity codec codes them. Units: see disparity_codec.cpp.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/codec/plane_nodes.h"

namespace farfield {

/// Steeper planes are not coded as planes, in units per sample. The coder's integers end at 2^24: of surfaces of at most 2^23
/// units (kMostTolerances), the value of another plane up to 2·64 samples away stays below 2^23 + 2^27 units, the difference
/// of two such below 2^24 steps of 2^kOffsetShift, and the difference of two slopes at 2^21.
inline constexpr double kSteepest = 1 << 20;
inline constexpr int kOffsetShift = 6;

struct Plane {
  std::int64_t c = 0, gx = 0, gy = 0;  // c at the tile's sample (0, 0), so that planes of different nodes compare
  std::int64_t at(int i, int j) const { return c + gx * i + gy * j; }
  bool operator==(const Plane&) const = default;
  static Plane through(std::int64_t value, int i, int j, std::int64_t gx, std::int64_t gy) { return {value - gx * i - gy * j, gx, gy}; }
};

/// Where on a surface its plane is known best, and how finely its slopes need be known.
struct SurfaceFrame {
  int x = 0, y = 0;                    // the middle of the surface's bounding box, in the tile
  int columns = 1, rows = 1;           // of the box
  SurfaceFrame(const Node& node, const NodeSamples& surface) {
    std::uint32_t all = 0;
    for (int row = surface.first_row; row < surface.end_row; ++row) all |= surface.rows[row];
    const int first = std::countr_zero(all), end = 32 - std::countl_zero(all);
    columns = end - first, rows = surface.end_row - surface.first_row;
    x = node.x + (first + end - 1) / 2, y = node.y + (surface.first_row + surface.end_row - 1) / 2;
  }
  /// Steps of a slope are 2^this: over a box of s samples half a step adds up to a quarter of the tolerance over two
  /// samples, and to an eighth over more.
  static int slope_shift(int extent) { return extent <= 2 ? 7 : extent <= 3 ? 6 : extent <= 4 ? 5 : extent <= 8 ? 4 : extent <= 16 ? 3 : 2; }
  /// Classes of size, 0 … 5: one sample, lines and boxes up to 2, 4, 8, 16 and 32.
  int size_class() const { return std::bit_width(static_cast<unsigned>(std::max(columns, rows) - 1)); }
};

/// Sums over samples at (x, y) of a node with value d.
struct Moments {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sd = 0, sxd = 0, syd = 0;
};
struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
};

/// Over all samples of a node, side by side in as many lanes as a vector register may hold.
template <int kSize>
struct WholeNode {
  static constexpr int kLanes = std::min(kSize, 8);

  static Moments moments(const float* disparity, int width, double units_per_disparity) {
    double sd[kLanes] = {}, sxd[kLanes] = {}, syd[kLanes] = {};
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; x += kLanes)
        for (int lane = 0; lane < kLanes; ++lane) {
          const double d = static_cast<double>(disparity[y * width + x + lane]) * units_per_disparity;
          sd[lane] += d, sxd[lane] += (x + lane) * d, syd[lane] += y * d;
        }
    constexpr double kSum = kSize * (kSize - 1) / 2, kSquares = kSum * (2 * kSize - 1) / 3;
    Moments m{.n = kSize * kSize, .sx = kSum * kSize, .sy = kSum * kSize, .sxx = kSquares * kSize, .sxy = kSum * kSum, .syy = kSquares * kSize};
    for (int lane = 0; lane < kLanes; ++lane) m.sd += sd[lane], m.sxd += sxd[lane], m.syd += syd[lane];
    return m;
  }
  static Range rest(const float* disparity, int width, double units_per_disparity, double gx, double gy) {
    double low[kLanes], high[kLanes];
    std::fill(low, low + kLanes, Range{}.low), std::fill(high, high + kLanes, Range{}.high);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; x += kLanes)
        for (int lane = 0; lane < kLanes; ++lane) {
          const double d = static_cast<double>(disparity[y * width + x + lane]) * units_per_disparity - (gx * (x + lane) + gy * y);
          low[lane] = d < low[lane] ? d : low[lane], high[lane] = d > high[lane] ? d : high[lane];
        }
    return {*std::min_element(low, low + kLanes), *std::max_element(high, high + kLanes)};
  }
};

/// Calls with the WholeNode of a node's size.
template <class Visit>
auto of_size(int size, Visit visit) {
  return size == 32 ? visit(WholeNode<32>()) : size == 16 ? visit(WholeNode<16>()) : size == 8 ? visit(WholeNode<8>()) : visit(WholeNode<4>());
}

/// Least squares over a surface's samples, in units per sample; zero where the samples leave a slope open.
struct Slopes {
  double x = 0, y = 0;
};
inline Slopes fit_slopes(const Moments& m) {
  const double mx = m.sx / m.n, my = m.sy / m.n, md = m.sd / m.n;
  const double cxx = m.sxx / m.n - mx * mx, cxy = m.sxy / m.n - mx * my, cyy = m.syy / m.n - my * my;
  const double cxd = m.sxd / m.n - mx * md, cyd = m.syd / m.n - my * md;
  const double determinant = cxx * cyy - cxy * cxy;
  // Sample positions are integers: a determinant below 1/1024 means that they lie on one line (or are one point).
  if (determinant > 1.0 / 1024) return {(cxd * cyy - cyd * cxy) / determinant, (cyd * cxx - cxd * cxy) / determinant};
  if (cxx + cyy <= 1.0 / 1024) return {};
  if (cxy < 0) {
    const double slope = (cxd - cyd) / (cxx + cyy - 2 * cxy);
    return {slope, -slope};
  }
  const double along = (cxd + cyd) / (cxx + cyy + 2 * cxy);
  return {cxx > 1.0 / 1024 ? along : 0, cyy > 1.0 / 1024 ? along : 0};
}

}  // namespace farfield

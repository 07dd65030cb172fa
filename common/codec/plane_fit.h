// SPDX-License-Identifier: Apache-2.0
// Planes over the surfaces of a node, rounded as the disparity codec codes them. Units: see disparity_codec.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/codec/plane_nodes.h"

namespace farfield {

inline constexpr int kOffsetShift = 5;
/// Steeper planes are not coded as planes, in units per sample. The coder's integers end at 2^24: of surfaces of at most 2^23
/// units (kMostTolerances), a plane's value at a corner up to 2·64 samples away stays below 2^23 + 2^27 units, the
/// difference of two such below 2^24 steps of 2^kOffsetShift, and the difference of two slopes at 2^21.
inline constexpr double kSteepest = 1 << 20;
inline int slope_shift(int node) { return node >= 32 ? 0 : node >= 16 ? 1 : node >= 8 ? 2 : 3; }

struct Plane {
  std::int64_t c = 0, gx = 0, gy = 0;  // c at the tile's sample (0, 0), so that planes of different nodes compare
  std::int64_t at(int i, int j) const { return c + gx * i + gy * j; }
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

/// Least squares over a surface's samples, recentred between the extremes, then rounded as it will be coded.
/// `rest_of(gx, gy)`: the Range of what slopes leave. Returns: whether the plane keeps to the tolerance.
template <class RestOf>
bool fit_plane(const Node& node, const Moments& m, RestOf rest_of, Plane& plane) {
  const double mx = m.sx / m.n, my = m.sy / m.n, md = m.sd / m.n;
  const double cxx = m.sxx / m.n - mx * mx, cxy = m.sxy / m.n - mx * my, cyy = m.syy / m.n - my * my;
  const double cxd = m.sxd / m.n - mx * md, cyd = m.syd / m.n - my * md;
  const double determinant = cxx * cyy - cxy * cxy;
  double gx = 0, gy = 0;
  // Sample positions are integers: a determinant below 1/1024 means that they lie on one line (or are one point).
  if (determinant > 1.0 / 1024) {
    gx = (cxd * cyy - cyd * cxy) / determinant;
    gy = (cyd * cxx - cxd * cxy) / determinant;
  } else if (cxx + cyy > 1.0 / 1024) {
    const double along = (cxd + cyd) / (cxx + cyy + 2 * std::abs(cxy));
    gx = cxx > 1.0 / 1024 ? along : 0, gy = cyy > 1.0 / 1024 ? (cxy < 0 ? -along : along) : 0;
    if (cxy < 0) {
      const double slope = (cxd - cyd) / (cxx + cyy - 2 * cxy);
      gx = slope, gy = -slope;
    }
  }
  const int shift = slope_shift(node.size);
  const auto quantised = [&](double value, int s) {
    return static_cast<std::int64_t>(std::llround(std::ldexp(value, -s))) * (std::int64_t{1} << s);
  };
  if (!(std::abs(gx) < kSteepest && std::abs(gy) < kSteepest)) return false;
  plane.gx = quantised(gx, shift), plane.gy = quantised(gy, shift);
  const Range rest = rest_of(static_cast<double>(plane.gx), static_cast<double>(plane.gy));
  const std::int64_t corner = quantised(0.5 * (rest.low + rest.high), kOffsetShift);
  plane.c = corner - plane.gx * node.x - plane.gy * node.y;
  // One unit below the tolerance absorbs the float the decoder rounds to.
  return std::max(rest.high - static_cast<double>(corner), static_cast<double>(corner) - rest.low) <= 255.0;
}

}  // namespace farfield

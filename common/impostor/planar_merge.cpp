// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/planar_merge.h"

#include <cmath>

namespace farfield {

void PlanarMerge::prepare(const SurfacePatch& patch, const std::vector<QuadKind>& kinds, float tolerance) {
  patch_ = patch;
  kinds_ = &kinds;
  tolerance_ = tolerance;
  if (!(tolerance > 0)) return;

  const int columns = patch.width - 1, rows = patch.height - 1;
  plain_.assign(static_cast<std::size_t>(patch.width) * patch.height, 0);
  for (int y = 0; y < rows; ++y) {
    std::uint32_t row = 0;
    for (int x = 0; x < columns; ++x) {
      row += kinds[static_cast<std::size_t>(y) * columns + x] == QuadKind::kPlain;
      plain_[patch.at(x + 1, y + 1)] = plain_[patch.at(x + 1, y)] + row;
    }
  }

  const std::size_t stride = static_cast<std::size_t>(patch.width) + 1;
  sums_.resize(stride * (patch.height + 1));
  for (std::size_t x = 0; x < stride; ++x) sums_[x] = {};
  for (int y = 0; y < patch.height; ++y) {
    const float* disparity = patch.disparity + patch.at(0, y);
    const std::uint8_t* coverage = patch.coverage + patch.at(0, y);
    const Sums* above = &sums_[y * stride];
    Sums* below = &sums_[(y + 1) * stride];
    double d = 0, xd = 0;
    below[0] = {};
    for (int x = 0; x < patch.width; ++x) {
      const double value = coverage[x] ? disparity[x] : 0.0;  // what stands at uncovered samples means nothing
      d += value;
      xd += x * value;
      below[x + 1] = {above[x + 1].d + d, above[x + 1].xd + xd, above[x + 1].yd + y * d};
    }
  }
}

bool PlanarMerge::is_plain(const QuadRect& r) const {
  const auto sum = [&](int x, int y) { return plain_[patch_.at(x, y)]; };
  return sum(r.x1, r.y1) + sum(r.x0, r.y0) - sum(r.x1, r.y0) - sum(r.x0, r.y1) ==
         static_cast<std::uint32_t>(r.quads());
}

DisparityPlane PlanarMerge::plane(const QuadRect& r) const {
  const std::size_t stride = static_cast<std::size_t>(patch_.width) + 1;
  const Sums &a = sums_[r.y0 * stride + r.x0], &b = sums_[r.y0 * stride + r.x1 + 1],
             &c = sums_[(r.y1 + 1) * stride + r.x0], &d = sums_[(r.y1 + 1) * stride + r.x1 + 1];
  const double columns = r.x1 - r.x0 + 1, rows = r.y1 - r.y0 + 1, samples = columns * rows;
  const double mean = (d.d - b.d - c.d + a.d) / samples;
  const double mean_x = 0.5 * (r.x0 + r.x1), mean_y = 0.5 * (r.y0 + r.y1);
  // On a full grid x and y are uncorrelated, so the slopes separate; the variance of 0 … n-1 is (n²-1)/12.
  DisparityPlane plane;
  plane.slope_x = ((d.xd - b.xd - c.xd + a.xd) / samples - mean_x * mean) * 12.0 / (columns * columns - 1.0);
  plane.slope_y = ((d.yd - b.yd - c.yd + a.yd) / samples - mean_y * mean) * 12.0 / (rows * rows - 1.0);
  plane.constant = mean - plane.slope_x * mean_x - plane.slope_y * mean_y;
  return plane;
}

bool PlanarMerge::is_planar(const QuadRect& r) const {
  const DisparityPlane fit = plane(r);
  const float limit = 0.5f * tolerance_, slope = static_cast<float>(fit.slope_x);
  for (int y = r.y0; y <= r.y1; ++y) {
    const float* disparity = patch_.disparity + patch_.at(r.x0, y);
    const float start = static_cast<float>(fit.at(r.x0, y));
    int outside = 0;
    for (int x = 0; x <= r.x1 - r.x0; ++x) {
      const float error = std::fabs(disparity[x] - (start + slope * static_cast<float>(x)));
      outside |= !(error <= limit);  // also where a value is not a number
    }
    if (outside) return false;
  }
  return true;
}

void PlanarMerge::divide(const QuadRect& r, std::vector<QuadRect>& out) const {
  const int width = r.x1 - r.x0, height = r.y1 - r.y0;
  if (width <= 0 || height <= 0) return;
  if (r.quads() == 1) {
    const QuadKind kind = (*kinds_)[static_cast<std::size_t>(r.y0) * (patch_.width - 1) + r.x0];
    if (kind != QuadKind::kNone) out.push_back(r);
    return;
  }
  if (tolerance_ > 0 && is_plain(r) && is_planar(r)) {
    out.push_back(r);
    return;
  }
  const auto x = static_cast<std::int16_t>(r.x0 + width / 2), y = static_cast<std::int16_t>(r.y0 + height / 2);
  divide({r.x0, r.y0, x, y}, out);
  divide({x, r.y0, r.x1, y}, out);
  divide({r.x0, y, x, r.y1}, out);
  divide({x, y, r.x1, r.y1}, out);
}

}  // namespace farfield

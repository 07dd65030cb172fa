// SPDX-License-Identifier: Apache-2.0
// Which samples of a run can reach a window of the screen.
#pragma once

#include <algorithm>
#include <cmath>

#include "client/warp/project_row.h"
#include "client/warp/tile_projection.h"

namespace farfield::client {

/// Samples [first, last] of a run.
struct SampleRange {
  double first = 0, last = 0;
};

/// Which samples of a run can reach the window, whatever disparity within the tile's range they have. A sample in front
/// of the eye that lands inside has (X, Y, w)·border >= 0 for the four borders; that is linear in u, v and disparity, so
/// each border leaves a half-line. Bands of the screen would otherwise project all of every run of a tile they cross.
class RunClipper {
 public:
  RunClipper(const TileProjection& p, const Splats& splats, const PixelWindow& window) {
    const double margin = kMaxReach;
    const glm::dvec3 borders[4] = {{1, 0, margin},
                                   {-1, 0, window.width + margin},
                                   {0, 1, margin - window.top},
                                   {0, -1, window.bottom + margin}};
    for (int k = 0; k < 4; ++k) {
      const double per_disparity = glm::dot(borders[k], p.per_disparity);
      largest_[k] = glm::dot(borders[k], p.origin) +
                    std::max(per_disparity * splats.min_disparity, per_disparity * splats.max_disparity);
      per_u_[k] = glm::dot(borders[k], p.per_u);
      per_v_[k] = glm::dot(borders[k], p.per_v);
      per_sample_[k] = per_u_[k] * splats.pitch;
    }
  }

  /// Whether all of the run lies beyond one border: cheaper than clip(), for runs too short to be worth it.
  bool is_outside(const SplatRun& run) const {
    bool is_outside = false;
    for (int k = 0; k < 4; ++k) {
      const double first = largest_[k] + run.u0 * per_u_[k] + run.v * per_v_[k];
      const double last = first + (run.count - 1) * per_sample_[k];
      is_outside |= std::max(first, last) < 0;
    }
    return is_outside;
  }

  SampleRange clip(const SplatRun& run) const {
    SampleRange range{0, static_cast<double>(run.count) - 1};
    for (int k = 0; k < 4; ++k) {
      const double value = largest_[k] + run.u0 * per_u_[k] + run.v * per_v_[k];
      const double crossing = -value / per_sample_[k];  // not finite where the run is parallel to the border
      if (per_sample_[k] > 0) {
        range.first = std::max(range.first, crossing);
      } else if (per_sample_[k] < 0) {
        range.last = std::min(range.last, crossing);
      } else if (value < 0) {
        return {1, 0};
      }
    }
    // To whole samples; the run's end may round outwards by one without harm.
    return {std::floor(range.first), std::min(std::ceil(range.last), static_cast<double>(run.count) - 1)};
  }

 private:
  // For each border: the most any sample at u = v = 0 can have, and what it changes by.
  double largest_[4], per_u_[4], per_v_[4], per_sample_[4];
};

}  // namespace farfield::client

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
/// of the eye that lands inside has (X, Y, w)·border >= 0 for the four borders; that is linear in the sample's number,
/// so each border leaves a half-line. Bands of the screen would otherwise project all of every run that crosses them.
class RunClipper {
 public:
  RunClipper(const TileProjection& p, const Splats& splats, const PixelWindow& window)
      : projection_(p) {
    const double margin = kMaxReach;
    borders_[0] = {1, 0, margin};
    borders_[1] = {-1, 0, window.width + margin};
    borders_[2] = {0, 1, margin - window.top};
    borders_[3] = {0, -1, window.bottom + margin};
    for (int k = 0; k < 4; ++k) {
      per_sample_[k] = glm::dot(borders_[k], p.per_u) * splats.pitch;
      const double per_disparity = glm::dot(borders_[k], p.per_disparity);
      largest_[k] = std::max(per_disparity * splats.min_disparity, per_disparity * splats.max_disparity);
    }
  }
  SampleRange clip(const SplatRun& run) const {
    SampleRange range{0, static_cast<double>(run.count) - 1};
    const glm::dvec3 start = projection_.at(run.u0, run.v, 0);
    for (int k = 0; k < 4; ++k) {
      const double value = glm::dot(borders_[k], start) + largest_[k];
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
  const TileProjection& projection_;
  glm::dvec3 borders_[4];
  double per_sample_[4], largest_[4];
};

}  // namespace farfield::client

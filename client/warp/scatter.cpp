// SPDX-License-Identifier: Apache-2.0
#include "client/warp/scatter.h"

#include <algorithm>
#include <cmath>

#include "client/warp/splat_key.h"

namespace farfield::client {
namespace {

inline void keep_larger(std::uint64_t& cell, std::uint64_t key) { cell = cell < key ? key : cell; }

void write_points(const ProjectedPoints& points, int count, std::uint64_t* keys) {
  for (int i = 0; i < count; ++i) {
    if (points.offset[i] >= 0) keep_larger(keys[points.offset[i]], make_key(points.high[i], points.low[i]));
  }
}

/// Splats of at most 2×2 pixels: the penalties of their first and last column and row are all there are.
void write_small_boxes(const ProjectedBoxes& boxes, int count, std::size_t width, std::uint64_t* keys) {
  for (int i = 0; i < count; ++i) {
    const int top = boxes.top[i], bottom = boxes.bottom[i], left = boxes.left[i], right = boxes.right[i];
    if (bottom < top || right < left) continue;
    const std::uint64_t key = make_key(boxes.high[i], boxes.low[i]);
    const std::uint64_t at_left = key - (std::uint64_t{boxes.left_penalty[i]} << kClosenessShift);
    const std::uint64_t at_right = key - (std::uint64_t{boxes.right_penalty[i]} << kClosenessShift);
    const auto write_row = [&](int row, std::uint32_t penalty) {
      std::uint64_t* line = keys + row * width;
      const std::uint64_t off = std::uint64_t{penalty} << kClosenessShift;
      keep_larger(line[left], at_left - off);
      if (right > left) keep_larger(line[right], at_right - off);
    };
    write_row(top, boxes.top_penalty[i]);
    if (bottom > top) write_row(bottom, boxes.bottom_penalty[i]);
  }
}

std::uint64_t penalty_of(float distance) {
  return static_cast<std::uint64_t>(
      std::min(kPenaltyPerSquarePixel * distance * distance, static_cast<float>(kPenaltyLimit)));
}

void write_boxes(const ProjectedBoxes& boxes, int count, std::size_t width, std::uint64_t* keys) {
  for (int i = 0; i < count; ++i) {
    const std::uint64_t key = make_key(boxes.high[i], boxes.low[i]);
    for (int row = boxes.top[i]; row <= boxes.bottom[i]; ++row) {
      const std::uint64_t in_row = key - (penalty_of(static_cast<float>(row) - boxes.row[i]) << kClosenessShift);
      for (int column = boxes.left[i]; column <= boxes.right[i]; ++column) {
        const std::uint64_t off = penalty_of(static_cast<float>(column) - boxes.column[i]) << kClosenessShift;
        keep_larger(keys[row * width + column], in_row - off);
      }
    }
  }
}

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
    const double margin = kMaxFootprint;
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

}  // namespace

void scatter_tile(const Splats& splats, const TileProjection& projection, const TileFootprint& footprint,
                  const PixelWindow& window, ProjectionKernel kernel, std::uint64_t* keys) {
  constexpr std::uint32_t kLongRun = 24;  // for shorter runs clipping costs as much as it saves
  const bool is_scalar = kernel == ProjectionKernel::kScalar;
  const auto width = static_cast<std::size_t>(window.width);
  RowProjection row{};
  for (int k = 0; k < 3; ++k) {
    row.step[k] = static_cast<float>(projection.per_u[k] * splats.pitch);
    row.per_disparity[k] = static_cast<float>(projection.per_disparity[k]);
  }
  row.disparity_scale = static_cast<float>(projection.disparity_scale);
  row.reach_x = footprint.reach_x;
  row.reach_y = footprint.reach_y;
  ProjectedPoints points;
  ProjectedBoxes boxes;
  const RunClipper clipper(projection, splats, window);
  for (const SplatRun& run : splats.runs) {
    std::uint32_t begin = 0, end = run.count;
    if (run.count >= kLongRun) {
      const SampleRange range = clipper.clip(run);
      if (!(range.first <= range.last)) continue;
      begin = static_cast<std::uint32_t>(range.first);
      end = static_cast<std::uint32_t>(range.last) + 1;
    }
    for (std::uint32_t done = begin; done < end;) {
      const std::uint32_t piece = done / kRowPiece * kRowPiece;
      const int count = static_cast<int>(std::min<std::uint32_t>(piece + kRowPiece, end) - done);
      const glm::dvec3 start = projection.at(run.u0 + static_cast<double>(splats.pitch) * piece, run.v, 0);
      for (int k = 0; k < 3; ++k) row.start[k] = static_cast<float>(start[k]);
      row.first = static_cast<int>(done - piece);
      const float* disparity = splats.disparity.data() + run.first + done;
      const std::uint32_t* colour = splats.colour.data() + run.first + done;
      done += static_cast<std::uint32_t>(count);
      if (footprint.widest == 1) {
        (is_scalar ? project_points_scalar : project_points)(row, window, disparity, colour, count, points);
        write_points(points, count, keys);
        continue;
      }
      (is_scalar ? project_boxes_scalar : project_boxes)(row, window, disparity, colour, count, boxes);
      if (footprint.widest == 2) {
        write_small_boxes(boxes, count, width, keys);
      } else {
        write_boxes(boxes, count, width, keys);
      }
    }
  }
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/warp/scatter.h"

#include <algorithm>

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

/// Whether a long run misses the window altogether: all of it lies on the outer side of one of its borders.
bool misses(const TileProjection& p, const Splats& splats, const SplatRun& run, const PixelWindow& window) {
  const double u1 = run.u0 + static_cast<double>(splats.pitch) * (run.count - 1);
  const double margin = kMaxFootprint;
  bool above = true, below = true, left = true, right = true;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 c =
        p.at(k & 1 ? u1 : run.u0, run.v, k & 2 ? splats.max_disparity : splats.min_disparity);
    above &= c.y < (window.top - margin) * c.z;
    below &= c.y > (window.bottom + margin) * c.z;
    left &= c.x < -margin * c.z;
    right &= c.x > (window.width + margin) * c.z;
  }
  return above || below || left || right;
}

}  // namespace

void scatter_tile(const Splats& splats, const TileProjection& projection, const TileFootprint& footprint,
                  const PixelWindow& window, ProjectionKernel kernel, std::uint64_t* keys) {
  constexpr std::uint32_t kLongRun = 24;  // for shorter runs the test costs as much as the work it saves
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
  for (const SplatRun& run : splats.runs) {
    if (run.count >= kLongRun && misses(projection, splats, run, window)) continue;
    for (std::uint32_t done = 0; done < run.count; done += kRowPiece) {
      const int count = static_cast<int>(std::min<std::uint32_t>(kRowPiece, run.count - done));
      const glm::dvec3 start = projection.at(run.u0 + static_cast<double>(splats.pitch) * done, run.v, 0);
      for (int k = 0; k < 3; ++k) row.start[k] = static_cast<float>(start[k]);
      const float* disparity = splats.disparity.data() + run.first + done;
      const std::uint32_t* colour = splats.colour.data() + run.first + done;
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

// SPDX-License-Identifier: Apache-2.0
// Projects a piece of a run: pixels and keys of consecutive samples. Two implementations of the same arithmetic: one
// written for the compiler's vectoriser, one scalar, step by step, as the reference; their results are bit-identical.
#pragma once

#include <array>
#include <cstdint>

namespace farfield::client {

/// Samples per call: small enough that the results stay in the first-level cache.
inline constexpr int kRowPiece = 256;

/// (X, Y, w) of sample i is start + (first + i)·step + disparity·per_disparity; see tile_projection.h. `start` belongs
/// to a fixed sample of the run whatever part of it is projected: rounding must not differ between bands.
struct RowProjection {
  float start[3], step[3], per_disparity[3];
  int first = 0;
  float disparity_scale = 1;         // 1/side
  float reach_x = 0, reach_y = 0;    // splat width × w, pixels
};

/// Splats are wider than their reach by this, pixels: what float arithmetic may put a sample's position off by, so that
/// pixel centres exactly between two samples are not left out.
inline constexpr float kRoundingMargin = 1.0f / 256.0f;

/// The pixels that may be written: [0, width) × [top, bottom).
struct PixelWindow {
  int width = 0, top = 0, bottom = 0;
};

/// For splats of one pixel.
struct ProjectedPoints {
  alignas(64) std::array<std::int32_t, kRowPiece> offset;  // row·width + column, or -1: nothing to write
  alignas(64) std::array<std::uint32_t, kRowPiece> high, low;
};

/// For wider splats: pixels [left, right] × [top, bottom], clipped; bottom < top: nothing to write. The keys have
/// full closeness; the penalties of the first and the last column and row are to be taken off.
struct ProjectedBoxes {
  alignas(64) std::array<std::int32_t, kRowPiece> left, right, top, bottom;
  alignas(64) std::array<std::uint32_t, kRowPiece> high, low;
  alignas(64) std::array<float, kRowPiece> column, row;  // of the splat's centre, in pixel centres
  alignas(64) std::array<std::uint32_t, kRowPiece> left_penalty, right_penalty, top_penalty, bottom_penalty;
};

/// Requires: count <= kRowPiece.
void project_points(const RowProjection& row, const PixelWindow& window, const float* disparity,
                    const std::uint32_t* colour, int count, ProjectedPoints& out);
void project_boxes(const RowProjection& row, const PixelWindow& window, const float* disparity,
                   const std::uint32_t* colour, int count, ProjectedBoxes& out);

void project_points_scalar(const RowProjection& row, const PixelWindow& window, const float* disparity,
                           const std::uint32_t* colour, int count, ProjectedPoints& out);
void project_boxes_scalar(const RowProjection& row, const PixelWindow& window, const float* disparity,
                          const std::uint32_t* colour, int count, ProjectedBoxes& out);

}  // namespace farfield::client

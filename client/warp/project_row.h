// SPDX-License-Identifier: Apache-2.0
// Projects consecutive samples: each sample's cell on its surface becomes a parallelogram on the screen, and each pixel
// whose centre lies in it gets the disparity and colour the surface has there.
//
// Two implementations of the same arithmetic: one written for the compiler's vectoriser, one scalar, step by step, as
// the reference; their results are bit-identical.
//
// Based on: Aliaga 1998 chapter 4 and Shade et al. 1998 (splat footprints from the warp's derivatives). Differs: the
// footprint is exact for planes, ends at recorded cuts, and pixels are sampled at their centres.
#pragma once

#include <array>
#include <cstdint>

#include "common/impostor/splats.h"

namespace farfield::client {

/// Samples per call: small enough that the results stay in the first-level cache.
inline constexpr int kRowPiece = 256;
/// What the widest vectors hold: the kernels are fastest where counts are multiples of it.
inline constexpr int kVectorSamples = 16;
static_assert(kRowPiece % kVectorSamples == 0);
/// A splat covers pixels up to this far from its sample; only surfaces stretched more than fourfold reach it.
inline constexpr int kMaxReach = 4;
/// Splats of up to this many pixels a side are drawn pixel by pixel of all at once, larger ones one by one.
inline constexpr int kNarrow = 2;
/// Splats are larger by this, samples: what float arithmetic may put a position off by, so that pixel centres exactly
/// between two samples are not left out.
inline constexpr float kRoundingMargin = 1.0f / 256.0f;
/// Where splats of nearly one disparity overlap, the one whose sample is closer wins: its disparity counts as smaller
/// by this share per squared sample spacing of distance.
inline constexpr float kDistancePenalty = 1.0f / 4096.0f;

/// Where views hold one surface, the finer samples show: a splat's disparity counts as smaller by this share per pixel that
/// it covers beyond the first, up to kLargestFootprint. It decides between views that differ by what coding leaves, and
/// nothing that anybody sees. Half a decibel on a patterned floor along a corridor.
inline constexpr float kFootprintPenalty = 1.0f / 4096.0f;
inline constexpr float kLargestFootprint = 8.0f;

/// (X, Y, w), see tile_projection.h, changes by step_u from sample to sample along a row of the face, by step_v from
/// row to row.
struct RowProjection {
  float step_u[3], step_v[3], per_disparity[3];
  float disparity_scale = 1;         // 1/side
};

/// The pixels that may be written: [0, width) × [top, bottom).
struct PixelWindow {
  int width = 0, top = 0, bottom = 0;
};

/// At most kRowPiece samples that follow each other in a tile's arrays: a run, a part of one, or several.
/// (X, Y, w) of sample i is infinity[i] + disparity[i]·per_disparity. Colours left and right only count where
/// the reach says kReachConnected.
struct RowSamples {
  int count = 0;
  const float* disparity = nullptr;
  const float *slope_u = nullptr, *slope_v = nullptr;  // of the disparity, per sample
  const std::uint16_t* reach = nullptr;
  const std::uint32_t *colour = nullptr, *colour_left = nullptr, *colour_right = nullptr;
  const std::uint32_t *colour_up = nullptr, *colour_down = nullptr;
  alignas(64) std::array<float, kRowPiece> infinity_x, infinity_y, infinity_w;
};

/// Pixel (column, row) of sample i has cell coordinates s = s_x·(column − x) + s_y·(row − y), t alike, in samples, and
/// eye disparity disparity + s·disparity_s + t·disparity_t. Pixels [left, right] × [top, bottom], clipped, may lie in
/// the cell −reach_left <= s <= reach_right, −reach_up <= t <= reach_down; bottom < top: there are none. `wide` is
/// 0 where there are more than kNarrow of them in a row or column, else -1. `second_column`, `second_line`: all bits if
/// some sample has more than one pixel in a row, in a column, else 0.
struct ProjectedRow {
  alignas(64) std::array<float, kRowPiece> x, y, s_x, s_y, t_x, t_y, disparity, disparity_s, disparity_t;
  alignas(64) std::array<std::int32_t, kRowPiece> left, right, top, bottom, wide;
  std::int32_t second_column = 0, second_line = 0;
};

/// Pixel (left + dx, top + dy) of each sample: its index row·width + column, or -1, and the halves of its key.
struct SplatPixels {
  alignas(64) std::array<std::int32_t, kRowPiece> offset;
  alignas(64) std::array<std::uint32_t, kRowPiece> high, low;
};

void project_row(const RowProjection& projection, const PixelWindow& window, const RowSamples& samples,
                 ProjectedRow& out);
void sample_pixels(const ProjectedRow& row, const RowSamples& samples, int width, int dx, int dy, SplatPixels& out);

void project_row_scalar(const RowProjection& projection, const PixelWindow& window, const RowSamples& samples,
                        ProjectedRow& out);
void sample_pixels_scalar(const ProjectedRow& row, const RowSamples& samples, int width, int dx, int dy,
                          SplatPixels& out);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/warp/wide_splats.h"

#include <algorithm>
#include <cmath>

#include "client/warp/hidden_pixels.h"
#include "client/warp/splat_pixel.h"
#include "client/warp/write_pixels.h"

namespace farfield::client {
namespace {

constexpr int kBlockEdge = 4;
constexpr int kBlockPixels = kBlockEdge * kBlockEdge;

/// Whether nothing of the splat can be seen, as behind near geometry. It reaches less than one sample from its own along
/// either axis, so this is the nearest it can be.
bool is_hidden(const ProjectedRow& row, int i, int width, const std::uint64_t* keys) {
  const float nearest = row.disparity[i] + std::fabs(row.disparity_s[i]) + std::fabs(row.disparity_t[i]);
  return are_hidden({row.left[i], row.right[i], row.top[i], row.bottom[i]}, nearest, width, keys);
}

}  // namespace

void draw_wide_splat(const ProjectedRow& row, const RowSamples& samples, int i, int width, std::uint64_t* keys) {
  if (is_hidden(row, i, width, keys)) return;
  const SplatAt splat(row, samples, i);
  const int left = row.left[i], right = row.right[i], bottom = row.bottom[i];
  alignas(64) std::array<std::int32_t, kBlockPixels> offset;
  alignas(64) std::array<std::uint32_t, kBlockPixels> high, low;
  std::array<std::int32_t, 2 * kBlockPixels> hits;
  for (int block_line = row.top[i]; block_line <= bottom; block_line += kBlockEdge) {
    for (int block_column = left; block_column <= right; block_column += kBlockEdge) {
#pragma GCC ivdep
      for (int k = 0; k < kBlockPixels; ++k) {
        const int column = block_column + (k & (kBlockEdge - 1)), line = block_line + k / kBlockEdge;
        const SplatPixel pixel = splat_pixel(splat, column, line);
        const int inside = pixel.is_inside & mask_of(column <= right) & mask_of(line <= bottom);
        offset[k] = select(inside, line * width + column, -1);
        high[k] = pixel.high;
        low[k] = pixel.low;
      }
      const int found = find_non_negative(offset.data(), kBlockPixels, hits.data());
      for (int h = 0; h < found; ++h) {
        const int k = hits[h];
        keep_larger(keys[offset[k]], make_key(high[k], low[k]));
      }
    }
  }
}

void draw_wide_splats_scalar(const ProjectedRow& row, const RowSamples& samples, int width, std::uint64_t* keys) {
  int columns = 0, lines = 0;
  for (int i = 0; i < samples.count; ++i) {
    if (row.wide[i] < 0) continue;
    columns = std::max(columns, row.right[i] - row.left[i] + 1), lines = std::max(lines, row.bottom[i] - row.top[i] + 1);
  }
  SplatPixels pixels;
  for (int dy = 0; dy < lines; ++dy) {
    for (int dx = 0; dx < columns; ++dx) {
      sample_pixels_scalar(row, samples, width, dx, dy, pixels);
      for (int i = 0; i < samples.count; ++i)
        if (pixels.offset[i] >= 0) keep_larger(keys[pixels.offset[i]], make_key(pixels.high[i], pixels.low[i]));
    }
  }
}

}  // namespace farfield::client

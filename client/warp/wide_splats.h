// SPDX-License-Identifier: Apache-2.0
// A store for splats that may cover more than one pixel: their first pixels are drawn with all others', the rest here.
#pragma once

#include <array>
#include <cstdint>

#include "client/warp/project_row.h"
#include "client/warp/write_pixels.h"

namespace farfield::client {

/// Splats that may cover more than one pixel, taken out of the pieces they were projected in: one in five does, and the
/// passes over their further pixels should not have to carry all others along.
class WideSplats {
 public:
  WideSplats() {
    samples_.count = 0;
    samples_.reach = reach_.data();
    samples_.colour = colour_.data();
    samples_.colour_left = left_.data(), samples_.colour_right = right_.data();
    samples_.colour_up = up_.data(), samples_.colour_down = down_.data();
  }
  bool is_full() const { return samples_.count == kRowPiece; }

  void append(const ProjectedRow& row, const RowSamples& samples, int i) {
    const int n = samples_.count++;
    row_.x[n] = row.x[i], row_.y[n] = row.y[i];
    row_.s_x[n] = row.s_x[i], row_.s_y[n] = row.s_y[i], row_.t_x[n] = row.t_x[i], row_.t_y[n] = row.t_y[i];
    row_.disparity[n] = row.disparity[i];
    row_.disparity_s[n] = row.disparity_s[i], row_.disparity_t[n] = row.disparity_t[i];
    row_.left[n] = row.left[i], row_.right[n] = row.right[i], row_.top[n] = row.top[i], row_.bottom[n] = row.bottom[i];
    reach_[n] = samples.reach[i];
    colour_[n] = samples.colour[i];
    left_[n] = samples.colour_left[i], right_[n] = samples.colour_right[i];
    up_[n] = samples.colour_up[i], down_[n] = samples.colour_down[i];
  }

  /// Draws all but their first pixels, by `sample` (one of the two sample_pixels), and forgets them.
  void draw(decltype(&sample_pixels) sample, int width, SplatPixels& pixels, RowIndices& hits, std::uint64_t* keys);

 private:
  void write_beyond_four(int i, int width, std::uint64_t* keys) const;

  RowSamples samples_;
  ProjectedRow row_;
  std::array<std::uint16_t, kRowPiece> reach_;
  std::array<std::uint32_t, kRowPiece> colour_, left_, right_, up_, down_;
};

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// Near geometry that was drawn elsewhere, a picture with depth, for the CPU warper.
#pragma once

#include <cstring>
#include <span>

#include "client/warp/near_rows.h"
#include "client/warp/splat_key.h"

namespace farfield::client {

/// Of the frame's size, or half of it in both directions. Arrays are [row][column], top row first, and outlive this.
class NearLayer final : public NearRows {
 public:
  /// `rgba`: alpha is not used. `disparity` times `disparity_scale`: per metre; 0: nothing is there.
  NearLayer(int width, int height, std::span<const std::uint8_t> rgba, std::span<const float> disparity, float disparity_scale)
      : width_(width), height_(height), rgba_(rgba), disparity_(disparity), disparity_scale_(disparity_scale) {}

  void draw_rows(const Display& pixels, int first_row, int last_row, std::uint64_t* keys) const override {
    for (int y = first_row; y < last_row; ++y) {
      for (int x = 0; x < pixels.width; ++x) {
        const auto at = static_cast<std::size_t>(y * height_ / pixels.height * width_ + x * width_ / pixels.width);
        std::uint32_t colour = 0;
        std::memcpy(&colour, &rgba_[4 * at], 4);
        const float disparity = disparity_[at] * disparity_scale_;
        keys[y * pixels.width + x] = disparity > 0 ? near_key(disparity, colour) : kNoSplat;
      }
    }
  }

 private:
  int width_, height_;
  std::span<const std::uint8_t> rgba_;
  std::span<const float> disparity_;
  float disparity_scale_;
};

}  // namespace farfield::client

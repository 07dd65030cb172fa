// SPDX-License-Identifier: Apache-2.0
// Averages an image down by a whole factor while its rows arrive, so that the full image is never held.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/shading/shading.h"
#include "server/model/model.h"

namespace farfield {

/// The smallest power of two that brings `edge` down to `limit`.
inline int reduction_factor(int edge, int limit) {
  int factor = 1;
  while ((edge + factor - 1) / factor > limit) factor *= 2;
  return factor;
}

/// Takes RGBA rows of `width` texels; every `factor` rows make one row of the result, averaged in linear light.
class RowReducer {
 public:
  RowReducer(int width, int height, int factor) : width_(width), height_(height), factor_(factor) {
    image_.width = (width + factor - 1) / factor;
    image_.height = (height + factor - 1) / factor;
    image_.rgba.resize(std::size_t{4} * static_cast<std::size_t>(image_.width) *
                       static_cast<std::size_t>(image_.height));
    if (factor > 1) sums_.resize(static_cast<std::size_t>(image_.width) * 4);
  }

  void add_row(const std::uint8_t* rgba) {
    const std::size_t row_bytes = static_cast<std::size_t>(image_.width) * 4;
    std::uint8_t* target = image_.rgba.data() + static_cast<std::size_t>(row_ / factor_) * row_bytes;
    if (factor_ == 1) {
      std::copy(rgba, rgba + row_bytes, target);
      ++row_;
      return;
    }
    for (int x = 0; x < width_; ++x) {
      float* sum = sums_.data() + 4 * (x / factor_);
      for (int c = 0; c < 3; ++c) sum[c] += srgb_to_linear(rgba[4 * x + c]);
      sum[3] += rgba[4 * x + 3];
    }
    ++row_;
    if (row_ % factor_ != 0 && row_ != height_) return;
    const int rows = row_ % factor_ == 0 ? factor_ : row_ % factor_;
    for (int x = 0; x < image_.width; ++x) {
      const float texels = static_cast<float>(rows * std::min(factor_, width_ - x * factor_));
      for (int c = 0; c < 3; ++c) target[4 * x + c] = linear_to_srgb(sums_[4 * x + c] / texels);
      target[4 * x + 3] = static_cast<std::uint8_t>(std::lround(sums_[4 * x + 3] / texels));
    }
    std::fill(sums_.begin(), sums_.end(), 0.0f);
  }

  TextureImage take() { return std::move(image_); }

 private:
  int width_, height_, factor_;
  int row_ = 0;
  TextureImage image_;
  std::vector<float> sums_;  // one result row, RGBA
};

}  // namespace farfield

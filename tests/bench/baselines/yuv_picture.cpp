// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/yuv_picture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace farfield::bench {
namespace {

// ITU-R BT.709-6, sections 3.2 and 3.4: luma weights, and 219 codes of luma from 16, 224 of chroma around 128.
constexpr float kRed = 0.2126f, kBlue = 0.0722f, kGreen = 1 - kRed - kBlue;
constexpr float kLuma = 219.0f / 255, kChroma = 224.0f / 255;

std::uint8_t code(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
}

}  // namespace

void rgb_to_yuv(std::span<const std::uint8_t> rgb, int width, int height, int step, const Plane<std::uint8_t> (&planes)[3]) {
  const auto luma = [](const std::uint8_t* p) { return kRed * p[0] + kGreen * p[1] + kBlue * p[2]; };
  tbb::parallel_for(0, height / step, [&](int block_row) {
    for (int y = block_row * step; y < (block_row + 1) * step; ++y)
      for (int x = 0; x < width; ++x)
        planes[0].rows[static_cast<std::ptrdiff_t>(y) * planes[0].stride + x] =
            code(16 + kLuma * luma(&rgb[3 * (static_cast<std::size_t>(y) * width + x)]));
    for (int block = 0; block < width / step; ++block) {
      float blue = 0, red = 0;
      for (int k = 0; k < step * step; ++k) {
        const std::uint8_t* p = &rgb[3 * (static_cast<std::size_t>(block_row * step + k / step) * width + block * step + k % step)];
        blue += p[2] - luma(p), red += p[0] - luma(p);
      }
      const float scale = kChroma / static_cast<float>(step * step);
      planes[1].rows[static_cast<std::ptrdiff_t>(block_row) * planes[1].stride + block] = code(128 + scale * blue / (2 * (1 - kBlue)));
      planes[2].rows[static_cast<std::ptrdiff_t>(block_row) * planes[2].stride + block] = code(128 + scale * red / (2 * (1 - kRed)));
    }
  });
}

std::vector<std::uint8_t> yuv_to_rgb(const Plane<const std::uint8_t> (&planes)[3], int width, int height, int step) {
  std::vector<std::uint8_t> rgb(std::size_t{3} * width * height);
  const int chroma_width = width / step, chroma_height = height / step;
  tbb::parallel_for(0, height, [&](int y) {
    // At half resolution a pixel lies a quarter of the way from its own chroma sample to the next one.
    const int own_row = y / step, next_row = step == 1 ? own_row : std::clamp(own_row + (y % 2 ? 1 : -1), 0, chroma_height - 1);
    std::vector<float> chroma[2];
    for (int c = 0; c < 2; ++c) {
      const std::uint8_t* own = planes[c + 1].rows + static_cast<std::ptrdiff_t>(own_row) * planes[c + 1].stride;
      const std::uint8_t* next = planes[c + 1].rows + static_cast<std::ptrdiff_t>(next_row) * planes[c + 1].stride;
      chroma[c].resize(static_cast<std::size_t>(chroma_width));
      for (int x = 0; x < chroma_width; ++x) chroma[c][static_cast<std::size_t>(x)] = (0.75f * own[x] + 0.25f * next[x] - 128) / kChroma;
    }
    const std::uint8_t* luma_row = planes[0].rows + static_cast<std::ptrdiff_t>(y) * planes[0].stride;
    std::uint8_t* out = &rgb[std::size_t{3} * y * width];
    for (int x = 0; x < width; ++x, out += 3) {
      const auto own = static_cast<std::size_t>(x / step);
      const auto next =
          step == 1 ? own : static_cast<std::size_t>(std::clamp(static_cast<int>(own) + (x % 2 ? 1 : -1), 0, chroma_width - 1));
      const float luma = (static_cast<float>(luma_row[x]) - 16) / kLuma;
      const float blue = (0.75f * chroma[0][own] + 0.25f * chroma[0][next]) * 2 * (1 - kBlue),
                  red = (0.75f * chroma[1][own] + 0.25f * chroma[1][next]) * 2 * (1 - kRed);
      out[0] = code(luma + red), out[1] = code(luma - (kBlue * blue + kRed * red) / kGreen), out[2] = code(luma + blue);
    }
  });
  return rgb;
}

}  // namespace farfield::bench

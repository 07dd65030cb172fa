// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/yuv_picture.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace farfield::bench {
namespace {

constexpr int kWidth = 16, kHeight = 8;

struct Planes {
  int step;
  std::vector<std::uint8_t> luma = std::vector<std::uint8_t>(kWidth * kHeight), blue = luma, red = luma;
};

Planes coded(const std::vector<std::uint8_t>& rgb, int step) {
  Planes p{step};
  rgb_to_yuv(rgb, kWidth, kHeight, step, {{p.luma.data(), kWidth}, {p.blue.data(), kWidth}, {p.red.data(), kWidth}});
  return p;
}
std::vector<std::uint8_t> decoded(const Planes& p) {
  return yuv_to_rgb({{p.luma.data(), kWidth}, {p.blue.data(), kWidth}, {p.red.data(), kWidth}}, kWidth, kHeight, p.step);
}

TEST(YuvPicture, BlackWhiteAndPrimariesHaveTheStandardsCodes) {
  const std::uint8_t colours[][6] = {
      {0, 0, 0, 16, 128, 128}, {255, 255, 255, 235, 128, 128}, {255, 0, 0, 63, 102, 240}, {0, 0, 255, 32, 240, 118}};
  for (const auto& c : colours) {
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < kWidth * kHeight; ++i) rgb.insert(rgb.end(), c, c + 3);
    for (const int step : {1, 2}) {
      const Planes p = coded(rgb, step);
      EXPECT_EQ(p.luma[0], c[3]);
      EXPECT_EQ(p.blue[0], c[4]);
      EXPECT_EQ(p.red[0], c[5]);
    }
  }
}

TEST(YuvPicture, FullChromaComesBackWithinRounding) {
  std::vector<std::uint8_t> rgb;
  for (int i = 0; i < 3 * kWidth * kHeight; ++i) rgb.push_back(static_cast<std::uint8_t>(i * 7919 % 256));
  const auto back = decoded(coded(rgb, 1));
  // Half a code of luma is 0.58 of RGB, half a code of chroma at most 1.06 (blue); then rounded again.
  for (std::size_t i = 0; i < rgb.size(); ++i) EXPECT_LE(std::abs(back[i] - rgb[i]), 2) << i;
}

TEST(YuvPicture, HalfChromaIsExactOnRamps) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (const int v : {60 + 4 * x, 100 + 2 * y, 200 - 3 * x - 2 * y}) rgb.push_back(static_cast<std::uint8_t>(v));
  const auto back = decoded(coded(rgb, 2));
  for (int y = 1; y + 1 < kHeight; ++y)  // at the rim chroma goes on unchanged
    for (int x = 1; x + 1 < kWidth; ++x)
      for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(back[3 * (y * kWidth + x) + c] - rgb[3 * (y * kWidth + x) + c]), 2) << x << ' ' << y;
}

}  // namespace
}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// What interpolation blurs is taken back, on surfaces and nowhere else.
#include "server/impostor/sharpen_colours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

Tile surface(int width, int height) {
  Tile tile;
  tile.width = width, tile.height = height;
  tile.coverage.assign(tile.samples(), 1);
  tile.cut_right.assign(tile.samples(), kConnected);
  tile.cut_down.assign(tile.samples(), kConnected);
  return tile;
}

std::vector<std::uint8_t> grey(const Tile& tile, const auto& level) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < tile.height; ++y)
    for (int x = 0; x < tile.width; ++x) rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(level(x, y))));
  return rgb;
}

// Squared error of a row, looked up bilinearly, against the mean over pixels as wide as samples, of a wave.
double row_error(const std::vector<std::uint8_t>& rgb, int width, double frequency, bool is_down) {
  constexpr double kPi = std::numbers::pi;
  const double pixel = std::sin(kPi * frequency) / (kPi * frequency);  // what a pixel's mean leaves of the wave
  double sum = 0;
  int count = 0;
  for (double at = 4; at < width - 5; at += 0.125, ++count) {
    const int first = static_cast<int>(at);
    const double t = at - first;
    const auto level = [&](int k) { return static_cast<double>(rgb[3 * static_cast<std::size_t>(is_down ? k * width + 8 : 8 * width + k)]); };
    const double shown = (1 - t) * level(first) + t * level(first + 1);
    const double error = shown - (128 + 100 * pixel * std::sin(2 * kPi * frequency * at));
    sum += error * error;
  }
  return sum / count;
}

TEST(SharpenColours, BilinearLookUpsComeCloserToThePixelsMean) {
  Tile tile = surface(64, 64);
  for (const bool is_down : {false, true}) {
    for (const double frequency : {0.08, 0.15, 0.22, 0.3}) {
      // Each sample is the mean of its area, as several rays or a filter as wide as the spacing make it.
      const double area = std::sin(std::numbers::pi * frequency) / (std::numbers::pi * frequency);
      auto rgb = grey(tile, [&](int x, int y) { return 128 + 100 * area * std::sin(2 * std::numbers::pi * frequency * (is_down ? y : x)); });
      const double before = row_error(rgb, 64, frequency, is_down);
      sharpen_colours(tile, rgb);
      EXPECT_LT(row_error(rgb, 64, frequency, is_down), 0.8 * before + 0.2) << frequency;  // 0.2: rounding, twice 1/12
    }
  }
}

TEST(SharpenColours, EvenColoursAndRampsStay) {
  Tile tile = surface(32, 32);
  const auto ramp = grey(tile, [](int x, int y) { return 3 * x + 2 * y; });
  auto rgb = ramp;
  sharpen_colours(tile, rgb);
  EXPECT_EQ(rgb, ramp);
}

TEST(SharpenColours, NothingCrossesACutOrAnUncoveredSample) {
  Tile tile = surface(16, 16);
  for (int y = 0; y < 16; ++y) tile.cut_right[static_cast<std::size_t>(16 * y + 7)] = 4;
  for (int x = 0; x < 16; ++x) tile.coverage[static_cast<std::size_t>(16 * 8 + x)] = 0;
  const auto two = grey(tile, [](int x, int y) { return (x < 8 ? 40 : 200) + (y < 8 ? 0 : 30); });
  auto rgb = two;
  sharpen_colours(tile, rgb);
  EXPECT_EQ(rgb, two);
}

TEST(SharpenColours, BlocksOfPackedTilesAreNotNeighbours) {
  Tile tile = surface(2 * kBlockSamples, kBlockSamples);
  tile.id.view = 1;
  ASSERT_TRUE(tile.is_packed());
  tile.blocks = {{0, 0}, {7, 7}};
  const auto two = grey(tile, [](int x, int) { return x < kBlockSamples ? 40 : 200; });
  auto rgb = two;
  sharpen_colours(tile, rgb);
  EXPECT_EQ(rgb, two);
}

TEST(SharpenColours, LevelsStayInRange) {
  Tile tile = surface(16, 16);
  auto rgb = grey(tile, [](int x, int y) { return (x + y) % 2 ? 255 : 0; });
  const auto before = rgb;
  sharpen_colours(tile, rgb);
  EXPECT_EQ(rgb, before);
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/codec/colour_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/codec/colour_quantiser.h"

namespace farfield {
namespace {

// Broad waves with a little noise, over a disc or everything.
Tile waves(bool is_whole, unsigned seed = 1) {
  Tile tile;
  tile.width = tile.height = kTileSamples;
  const std::size_t n = tile.samples();
  tile.coverage.assign(n, 1), tile.disparity.assign(n, 0), tile.rgb.assign(3 * n, 128);
  tile.cut_right.assign(n, 0), tile.cut_down.assign(n, 0);
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(i % kTileSamples), y = static_cast<double>(i / kTileSamples);
    if (!is_whole) tile.coverage[i] = std::hypot(x - 60, y - 55) < 50;
    for (int c = 0; c < 3; ++c)
      tile.rgb[3 * i + c] = static_cast<std::uint8_t>(128 + 60 * std::sin(0.2 * x + c) * std::cos(0.13 * y) + static_cast<int>(random() % 9) - 4);
  }
  return tile;
}

double mean_square(const Tile& tile, const std::vector<std::uint8_t>& rgb) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    if (!tile.coverage[i / 3]) continue;
    sum += std::pow(int{tile.rgb[i]} - int{rgb[i]}, 2), count += 1;
  }
  return sum / count;
}

TEST(BlockTransform, IsOrthonormalAndItsOwnInverse) {
  const BlockTransform transform;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> value(-128, 128);
  BlockPlane samples;
  for (float& sample : samples) sample = value(random);
  const BlockPlane coefficients = transform.forward(samples), back = transform.inverse(coefficients);
  double before = 0, after = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_NEAR(back[k], samples[k], 1e-3);
    before += double{samples[k]} * samples[k], after += double{coefficients[k]} * coefficients[k];
  }
  EXPECT_NEAR(after / before, 1.0, 1e-5);
  BlockPlane slope;  // varies along rows only
  for (std::size_t k = 0; k < slope.size(); ++k) slope[k] = static_cast<float>(k % 8);
  const BlockPlane of_slope = transform.forward(slope);
  EXPECT_LT(of_slope[1], -1);
  EXPECT_NEAR(of_slope[8], 0, 1e-4);
}

// Of a quantiser with this step: at most step²/12 where every coefficient counts, and what is dropped below that.
TEST(ColourCodec, ErrorFollowsTheStepAndBytesFallWithIt) {
  const Tile tile = waves(true);
  const TileBits bits(tile);
  double last_error = 0;
  std::size_t last_size = ~std::size_t{0};
  for (const int quality : {100, 97, 90, 76, 60, 40, 10, 1}) {
    const Bytes bytes = encode_colour(tile.rgb, bits, quality);
    const double error = mean_square(tile, decode_colour(bytes, bits, quality)), step = colour_step(quality);
    // Red, green and blue each are luma plus up to 1.8 colour differences; the coarsest step is 1.5 times this; bytes round by a level.
    EXPECT_LT(error, 4 * 1.5 * 1.5 * step * step / 12 + 0.5) << quality;
    EXPECT_GE(error, last_error) << quality;
    EXPECT_LT(bytes.size(), last_size) << quality;
    last_error = error, last_size = bytes.size();
  }
}

TEST(ColourCodec, WhatNothingCoversCostsNothing) {
  Tile tile = waves(false);
  const TileBits bits(tile);
  const Bytes bytes = encode_colour(tile.rgb, bits, 76);
  const auto rgb = decode_colour(bytes, bits, 76);
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    if (tile.coverage[i]) continue;
    ASSERT_TRUE(rgb[3 * i] == 128 && rgb[3 * i + 1] == 128 && rgb[3 * i + 2] == 128);
    tile.rgb[3 * i] = static_cast<std::uint8_t>(i * 77);
  }
  EXPECT_EQ(encode_colour(tile.rgb, bits, 76), bytes);
  // Half the samples: not more than their share, and a rim that is not harder than the whole.
  const Tile whole = waves(true);
  EXPECT_LT(static_cast<double>(bytes.size()), 0.6 * static_cast<double>(encode_colour(whole.rgb, TileBits(whole), 76).size()));
}

TEST(ColourBlocks, AnyLevelsComeBack) {
  Tile tile = waves(false, 3);
  const TileBits bits(tile);
  std::mt19937 random(5);
  std::vector<ColourBlock> blocks(static_cast<std::size_t>(bits.grid().size()));
  for (int b = 0; b < bits.grid().size(); ++b) {
    if (bits[b].covered == 0) continue;
    const unsigned density = b % 3 == 0 ? 1 : b % 3 == 1 ? 7 : 40;  // from every coefficient to few
    for (auto& plane : blocks[b].levels)
      for (auto& level : plane)
        if (random() % density == 0) level = static_cast<std::int16_t>(b % 7 == 0 ? static_cast<int>(random() % 65535) - 32767 : static_cast<int>(random() % 5) - 2);
  }
  const auto back = decode_colour_blocks(encode_colour_blocks(blocks, bits), bits);
  for (int b = 0; b < bits.grid().size(); ++b) ASSERT_EQ(back[b].levels, blocks[b].levels) << b;
}

TEST(ColourBlocks, AnyBytesGiveSomeLevels) {
  const Tile tile = waves(false);
  const TileBits bits(tile);
  std::mt19937 random(6);
  for (int round = 0; round < 50; ++round) {
    Bytes bytes(random() % 3000);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(round % 2 ? random() : 0xff);
    for (const auto& block : decode_colour_blocks(bytes, bits))
      for (const auto& plane : block.levels)
        for (const int level : plane) ASSERT_LE(std::abs(level), kLargestLevel);
    ASSERT_EQ(decode_colour(bytes, bits, 1).size(), 3 * tile.samples());
  }
}

}  // namespace
}  // namespace farfield

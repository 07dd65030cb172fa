// SPDX-License-Identifier: Apache-2.0
#include "common/codec/colour_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "common/base/hash.h"
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
  std::vector<ColourBlock> coded = blocks;
  const auto back = decode_colour_blocks(encode_colour_blocks(coded, bits), bits);
  for (int b = 0; b < bits.grid().size(); ++b) ASSERT_TRUE(back[b].levels == blocks[b].levels && coded[b].levels == blocks[b].levels) << b;
}

// A reader of this version must find what writers of it meant: the contexts of every decision are part of the format.
TEST(ColourBlocks, StreamsOfVersion4StayAsTheyAre) {
  const Tile tile = waves(false);
  const TileBits bits(tile);
  std::mt19937 random(7);
  std::vector<ColourBlock> blocks(static_cast<std::size_t>(bits.grid().size()));
  for (int b = 0; b < bits.grid().size(); ++b)
    for (auto& plane : blocks[b].levels) {
      plane[0] = static_cast<std::int16_t>(static_cast<int>(random() % 21) - 10);
      for (std::size_t k = 1; k < plane.size(); ++k)
        if (random() % (1 + k * (b % 5)) == 0) plane[k] = static_cast<std::int16_t>(static_cast<int>(random() % 7) - 3);
    }
  EXPECT_EQ(hash_bytes(encode_colour_blocks(blocks, bits)), ContentHash{12364322843450682466u});
}

// As colour_quantiser.cpp has it, one coefficient at a time and in double.
class SimpleQuantiser {
 public:
  static constexpr int kCount = kBlockSamples * kBlockSamples;
  using Values = std::array<double, kCount>;

  static Values transformed(const Values& in, bool is_inverse) {
    const auto basis = [](int k, int x) { return std::sqrt((k == 0 ? 1.0 : 2.0) / 8) * std::cos(3.14159265358979323846 * (2 * x + 1) * k / 16); };
    Values out{};
    for (int v = 0; v < 8; ++v)
      for (int u = 0; u < 8; ++u)
        for (int y = 0; y < 8; ++y)
          for (int x = 0; x < 8; ++x) out[v * 8 + u] += in[y * 8 + x] * (is_inverse ? basis(y, v) * basis(x, u) : basis(v, y) * basis(u, x));
    return out;
  }
  static Values coefficients(const ColourPlane& plane, const BlockPlane& steps) {
    Values samples{};
    double mean = 0, squares = 0;
    for (int k = 0; k < kCount; ++k) mean += plane.covered >> k & 1 ? plane.samples[k] : 0.0;
    mean /= std::popcount(plane.covered);
    for (int k = 0; k < kCount; ++k) {
      samples[k] = plane.covered >> k & 1 ? plane.samples[k] : mean;
      squares += (samples[k] - mean) * (samples[k] - mean);
    }
    Values result{};
    result[0] = 8 * mean / steps[0];
    if (squares < 0.558 * 0.558 * steps[1] * steps[1]) return result;
    for (int round = 2; round >= 0 && ~plane.covered != 0; --round) {
      Values large = transformed(samples, false);
      for (int k = 1; k < kCount; ++k)
        if (std::abs(large[k]) < (0.6 + 0.5 * round) * steps[k]) large[k] = 0;
      const Values smooth = transformed(large, true);
      for (int k = 0; k < kCount; ++k)
        if (!(plane.covered >> k & 1)) samples[k] = smooth[k];
    }
    result = transformed(samples, false);
    for (int k = 0; k < kCount; ++k) result[k] /= steps[k];
    return result;
  }
  static std::vector<ColourBlock> run(const std::vector<ColourPlane>& planes, const ColourSteps& steps) {
    std::vector<Values> values(planes.size());
    std::vector<int> counts(planes.size(), 0);
    double seen[2][kCount] = {}, all[2] = {};
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (planes[i].covered == 0) continue;
      values[i] = coefficients(planes[i], steps.of(i % kColourPlanes));
      const int kind = i % kColourPlanes != 0;
      for (int k = 1; k < kCount; ++k)
        if (std::abs(values[i][k]) > 0.66) ++seen[kind][k], ++all[kind], ++counts[i];
    }
    std::vector<ColourBlock> blocks(planes.size() / kColourPlanes);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      auto& levels = blocks[i / kColourPlanes].levels[i % kColourPlanes];
      const int kind = i % kColourPlanes != 0;
      levels[0] = static_cast<std::int16_t>(std::lround(values[i][0]));
      for (int k = 1; k < kCount; ++k) {
        const double likely = std::clamp((counts[i] - 0.5) * (seen[kind][k] + 0.5) / (all[kind] + 32), 0.003, 0.9);
        const double bits = std::log2((1 - likely) / likely) + 1.5 + (counts[i] <= 1 ? 1.5 : 0.0), size = std::abs(values[i][k]);
        const double least = size < 1.5 ? 0.5 + 0.058 * std::max(1.0, bits) : 1.0;
        if (size >= least) levels[k] = static_cast<std::int16_t>(std::copysign(std::max(1.0, std::floor(size + 0.4)), values[i][k]));
      }
    }
    return blocks;
  }
};

TEST(ColourQuantiser, IsTheSimpleOneButForRounding) {
  std::mt19937 random(11);
  std::normal_distribution<float> noise(0, 1);
  std::vector<ColourPlane> planes(std::size_t{kColourPlanes} * 120);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::size_t block = i / kColourPlanes;
    // Whole, in part, flat, uncovered.
    planes[i].covered = block % 4 == 0 ? ~std::uint64_t{0} : block % 4 == 3 ? 0 : std::uint64_t{0x00ff3c7ef0180f3du} * (block * 2 + 1);
    for (int k = 0; k < SimpleQuantiser::kCount; ++k)
      if (planes[i].covered >> k & 1)
        planes[i].samples[k] = 20 * std::sin(0.3f * static_cast<float>(block + i % 3)) + (block % 5 == 0 ? 0.1f : 6.0f) * noise(random) + static_cast<float>(k % 8);
  }
  ColourSteps steps;
  for (int k = 0; k < SimpleQuantiser::kCount; ++k) steps.luma[k] = 4 + 0.1f * static_cast<float>(k), steps.difference[k] = 5 + 0.1f * static_cast<float>(k);
  const std::vector<ColourBlock> simple = SimpleQuantiser::run(planes, steps), fast = quantise_colours(planes, steps);
  ASSERT_EQ(simple.size(), fast.size());
  int sent = 0, different = 0;
  for (std::size_t b = 0; b < simple.size(); ++b)
    for (std::size_t p = 0; p < kColourPlanes; ++p)
      for (std::size_t k = 0; k < simple[b].levels[p].size(); ++k) {
        sent += simple[b].levels[p][k] != 0;
        different += simple[b].levels[p][k] != fast[b].levels[p][k];
      }
  EXPECT_GT(sent, 2000);
  EXPECT_LE(different, sent / 500);
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

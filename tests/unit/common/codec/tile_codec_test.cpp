// SPDX-License-Identifier: Apache-2.0
#include "common/codec/tile_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

// A slanted floor, a bright disc in front of it and a strip of nothing: every kind of edge a tile can have.
Tile dense_tile(unsigned seed) {
  Tile tile;
  tile.id = {{3, 100, -7, 12}, kIntraView, 2, 1, 2};
  tile.edge_samples = face_samples(4);
  tile.width = tile.height = kTileSamples;
  tile.view_offset = {0.1f, 0, -0.2f};
  tile.disparity_tolerance = 4e-4f;
  tile.certificate = {.void_rays = 40000, .void_hits = 3, .void_worst_hits = 2, .void_worst_rays = 3000, .colour_mse = {30, 20},
                      .colour_mse_error = {3, 2}, .disparity_p99 = 3e-4f, .missed_void = true};
  const std::size_t n = tile.samples();
  tile.coverage.assign(n, 1), tile.disparity.assign(n, 0), tile.rgb.assign(3 * n, 0);
  tile.cut_right.assign(n, 0), tile.cut_down.assign(n, 0);
  std::mt19937 random(seed);
  std::vector<int> surface(n, 0);
  for (int y = 0; y < kTileSamples; ++y)
    for (int x = 0; x < kTileSamples; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * kTileSamples + x;
      const double r = std::hypot(x - 70.0, y - 50.0);
      surface[i] = r < 20 ? 1 : (x > 100 && x < 105 ? 2 : 0);
      tile.coverage[i] = surface[i] != 2;
      if (surface[i] == 0) tile.disparity[i] = static_cast<float>(0.05 + 0.0011 * x + 0.0007 * y);
      if (surface[i] == 1) tile.disparity[i] = static_cast<float>(0.4 - 1e-4 * r * r);
      for (int c = 0; c < 3; ++c) tile.rgb[3 * i + c] = static_cast<std::uint8_t>(surface[i] == 1 ? 220 - 60 * c : 40 + x / 2);
    }
  for (int y = 0; y < kTileSamples; ++y)
    for (int x = 0; x < kTileSamples; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * kTileSamples + x;
      const auto cut = [&](std::size_t j) -> std::uint8_t {
        return surface[i] == surface[j] ? 0 : static_cast<std::uint8_t>(1 + random() % 8);
      };
      if (x + 1 < kTileSamples) tile.cut_right[i] = cut(i + 1);
      if (y + 1 < kTileSamples) tile.cut_down[i] = cut(i + kTileSamples);
    }
  return tile;
}

Tile packed_tile() {
  Tile tile;
  tile.id = {{0, 5, 6, 7}, 3, 4, 1, 0};
  tile.edge_samples = face_samples(12);
  tile.disparity_tolerance = 2e-4f;
  std::mt19937 random(5);
  for (int x = kRegionBlocks; x < 2 * kRegionBlocks; ++x)
    for (int y = 2; y < kRegionBlocks; ++y)
      if (random() % 3 == 0) tile.blocks.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  tile.width = packed_width(tile.blocks.size()), tile.height = packed_height(tile.blocks.size());
  const std::size_t n = tile.samples();
  tile.coverage.assign(n, 0), tile.disparity.assign(n, 0), tile.rgb.assign(3 * n, 99);
  tile.cut_right.assign(n, 0), tile.cut_down.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t block = i / tile.width / 8 * kPackedColumns + i % tile.width / 8;
    tile.coverage[i] = block < tile.blocks.size() && random() % 8 != 0;
    if (tile.coverage[i]) tile.disparity[i] = 0.3f + 0.01f * static_cast<float>(random() % 7);
  }
  const TileNeighbours neighbours(tile);
  for (std::size_t i = 0; i < n; ++i) {
    const int right = neighbours.right(static_cast<int>(i)), down = neighbours.down(static_cast<int>(i));
    const auto cut = [&](int j) -> std::uint8_t {
      if (j < 0 || (!tile.coverage[i] && !tile.coverage[j])) return 0;
      if (tile.coverage[i] != tile.coverage[j]) return static_cast<std::uint8_t>(1 + random() % 8);
      return std::abs(tile.disparity[i] - tile.disparity[j]) > 0.001f ? static_cast<std::uint8_t>(1 + random() % 8) : kConnected;
    };
    tile.cut_right[i] = cut(right), tile.cut_down[i] = cut(down);
  }
  return tile;
}

void expect_same(const Tile& a, const Tile& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.blocks, b.blocks);
  EXPECT_EQ(a.coverage, b.coverage);
  EXPECT_EQ(a.cut_right, b.cut_right);
  EXPECT_EQ(a.cut_down, b.cut_down);
  ASSERT_EQ(a.samples(), b.samples());
  double worst = 0;
  for (std::size_t i = 0; i < a.samples(); ++i)
    if (a.coverage[i]) worst = std::max<double>(worst, std::abs(double{a.disparity[i]} - double{b.disparity[i]}));
  EXPECT_LE(worst, a.disparity_tolerance);
}

// Measurements come back with two digits and never better than they were.
void expect_certificate(const Certificate& decoded, const Certificate& sent) {
  EXPECT_EQ(decoded.void_rays, sent.void_rays);
  EXPECT_EQ(decoded.void_hits, sent.void_hits);
  EXPECT_EQ(decoded.void_worst_rays, sent.void_worst_rays);
  EXPECT_EQ(decoded.void_worst_hits, sent.void_worst_hits);
  const auto expect_close = [](float seen, float wanted, float step) {
    EXPECT_GE(seen, wanted * 0.999f);
    EXPECT_LE(seen, wanted * step);
  };
  for (int k = 0; k < 2; ++k) {
    expect_close(decoded.colour_mse[k], sent.colour_mse[k], 1.07f);
    expect_close(decoded.colour_mse_error[k], sent.colour_mse_error[k], 1.07f);
  }
  expect_close(decoded.disparity_p99, sent.disparity_p99, 1.001f);
  EXPECT_EQ(decoded.missed_void, sent.missed_void);
  EXPECT_EQ(decoded.missed_colour, sent.missed_colour);
}

TEST(TileCodec, ACertificateCanBePutInAfterwardsAndIsKeptWhenPutInAgain) {
  const Tile tile = dense_tile(2);
  Bytes bytes = encode_tile(tile, {}).value();
  const Bytes before = bytes;
  Certificate other{.void_rays = 65535, .void_hits = 65535, .void_worst_hits = 1, .void_worst_rays = 2, .colour_mse = {0, 65025},
                    .colour_mse_error = {0.02f, 1e3f}, .disparity_p99 = 0, .missed_colour = true};
  set_certificate(bytes, other);
  const Tile decoded = decode_tile(bytes).value();
  expect_certificate(decoded.certificate, other);
  EXPECT_EQ(decoded.rgb, decode_tile(before)->rgb) << "and nothing else changes";
  Bytes again = bytes;
  set_certificate(again, decoded.certificate);
  EXPECT_EQ(again, bytes) << "coded values have codes of their own";
  set_certificate(bytes, Certificate{});
  EXPECT_EQ(decode_tile(bytes)->certificate, Certificate{}) << "not measured stays not measured";
}

TEST(TileCodec, MoreVoidsThanRaysAreRefused) {
  Bytes bytes = encode_tile(dense_tile(2), {}).value();
  set_certificate(bytes, {.void_rays = 10, .void_hits = 11});
  EXPECT_FALSE(decode_tile(bytes));
}

TEST(TileCodec, DenseTileComesBackWithinItsTolerance) {
  const Tile tile = dense_tile(1);
  TileBytes bytes;
  const auto encoded = encode_tile(tile, {}, &bytes);
  ASSERT_TRUE(encoded);
  const auto decoded = decode_tile(*encoded);
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_same(tile, *decoded);
  EXPECT_EQ(decoded->view_offset, tile.view_offset);
  expect_certificate(decoded->certificate, tile.certificate);
  EXPECT_LT(8.0 * bytes.disparity / bytes.covered_samples, 0.5);
  double squared = 0;
  for (std::size_t i = 0; i < tile.samples(); ++i)
    for (int c = 0; tile.coverage[i] && c < 3; ++c) squared += std::pow(tile.rgb[3 * i + c] - decoded->rgb[3 * i + c], 2);
  EXPECT_GT(10 * std::log10(255.0 * 255.0 * 3 * bytes.covered_samples / squared), 34.0);
}

TEST(TileCodec, PackedTileComesBackWithItsBlocks) {
  const Tile tile = packed_tile();
  const auto encoded = encode_tile(tile, {});
  ASSERT_TRUE(encoded);
  const auto decoded = decode_tile(*encoded);
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_same(tile, *decoded);
}

TEST(TileCodec, NoiseStaysWithinTolerance) {
  Tile tile = dense_tile(2);
  std::mt19937 random(9);
  std::uniform_real_distribution<float> noise(0.0f, 0.5f);
  for (std::size_t i = 0; i < tile.samples(); ++i)
    if (tile.coverage[i]) tile.disparity[i] = noise(random);
  const auto encoded = encode_tile(tile, {});
  ASSERT_TRUE(encoded);
  expect_same(tile, *decode_tile(*encoded));
}

// Certificates rest on it.
TEST(TileCodec, TheEncoderTellsWhatDecodersWillReturn) {
  std::vector<Tile> tiles{dense_tile(1), packed_tile(), dense_tile(2), dense_tile(3)};
  std::mt19937 random(13);
  std::uniform_real_distribution<float> noise(0.0f, 0.5f);
  for (std::size_t i = 0; i < tiles[2].samples(); ++i) {
    if (tiles[2].coverage[i]) tiles[2].disparity[i] = noise(random);
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) tiles[2].rgb[c] = static_cast<std::uint8_t>(random());
  }
  tiles[3].disparity_tolerance = 1e-8f;  // finer than floats are: coded with another
  for (const Tile& tile : tiles)
    for (const int quality : {100, 80, 30, 1}) {
      CodedSamples told;
      const auto encoded = encode_tile(tile, {quality}, nullptr, &told);
      ASSERT_TRUE(encoded);
      EXPECT_EQ(*encoded, encode_tile(tile, {quality}).value());
      const auto decoded = decode_tile(*encoded);
      ASSERT_TRUE(decoded);
      EXPECT_TRUE(told.rgb == decoded->rgb) << "quality " << quality;
      EXPECT_TRUE(told.disparity == decoded->disparity) << "quality " << quality;
    }
}

// Two samples of which one is nearly infinite make a plane of any slope: more than the coder's integers hold.
TEST(TileCodec, SpikesAtATinyToleranceStayWithinTheToleranceOfTheHeader) {
  for (const float tolerance : {1e-5f, 1e-8f, 1e-11f}) {
    Tile tile = dense_tile(4);
    tile.disparity_tolerance = tolerance;
    for (std::size_t i = 0; i < tile.samples(); ++i) {
      tile.coverage[i] = 1;
      tile.cut_down[i] = tile.cut_right[i] = 0;
      if (i / 128 < 127) tile.cut_down[i] = 4;
      if (i % 128 < 127 && i % 2 == 1) tile.cut_right[i] = 4;
      tile.disparity[i] = i % 2 ? 0.4f : 1e-4f;
    }
    const auto encoded = encode_tile(tile, {});
    ASSERT_TRUE(encoded);
    const auto decoded = decode_tile(*encoded);
    ASSERT_TRUE(decoded);
    EXPECT_FLOAT_EQ(decoded->disparity_tolerance, std::max(tolerance, 0.4f / 32768)) << "floats tell no more apart";
    tile.disparity_tolerance = decoded->disparity_tolerance;
    expect_same(tile, *decoded);
  }
}

TEST(TileCodec, RefusesDisparitiesThatAreNone) {
  for (const float value : {-0.1f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Tile tile = dense_tile(5);
    const auto at = static_cast<std::size_t>(std::find(tile.coverage.begin(), tile.coverage.end(), 1) - tile.coverage.begin());
    tile.disparity[at] = value;
    const auto refused = encode_tile(tile, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
    tile.disparity[at] = 0.1f;
    tile.disparity_tolerance = value;
    EXPECT_FALSE(encode_tile(tile, {}));
  }
}

TEST(TileCodec, OnePlaneCostsAFewBytes) {
  Tile tile = dense_tile(3);
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    tile.coverage[i] = 1, tile.cut_right[i] = tile.cut_down[i] = 0;
    tile.disparity[i] = static_cast<float>(0.1 + 0.0013 * (i % 128) - 0.0004 * (i / 128));
  }
  TileBytes bytes;
  ASSERT_TRUE(encode_tile(tile, {}, &bytes));
  EXPECT_LT(bytes.disparity, 60u);
  EXPECT_LT(bytes.topology, 20u);
}

TEST(TileCodec, EveryTruncationIsAnErrorOrATile) {
  for (const Tile& tile : {dense_tile(4), packed_tile()}) {
    const Bytes encoded = *encode_tile(tile, {});
    for (std::size_t size = 0; size < encoded.size(); size += 1 + size / 40)
      EXPECT_FALSE(decode_tile(ByteView(encoded).first(size)));
  }
}

TEST(TileCodec, DamagedBytesNeverCrash) {
  std::mt19937 random(11);
  for (const Tile& tile : {dense_tile(5), packed_tile()}) {
    const Bytes good = *encode_tile(tile, {});
    for (int round = 0; round < 300; ++round) {
      Bytes bad = good;
      for (int k = 0; k < 4; ++k) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
      const auto decoded = decode_tile(bad);
      if (!decoded) continue;
      for (const float d : decoded->disparity) ASSERT_TRUE(std::isfinite(d) && d >= 0);
    }
  }
}

TEST(TileCodec, ForeignBytesAndVersionsGetOneClearLine) {
  Bytes encoded = *encode_tile(dense_tile(6), {});
  EXPECT_EQ(decode_tile(Bytes{'P', 'N', 'G', 0, 0, 0}).error().code, ErrorCode::kBadData);
  encoded[2] = 77;
  EXPECT_EQ(decode_tile(encoded).error().code, ErrorCode::kVersionMismatch);
  EXPECT_EQ(decode_tile(*encode_tile(dense_tile(6), {}), {.edge_samples = 100}).error().code, ErrorCode::kLimitExceeded);
}

TEST(TileCodec, BeyondTheParallaxLimitThereIsNoDepth) {
  Tile tile = dense_tile(8);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> far(0.0f, 0.99f * tile.disparity_tolerance);
  // The left part, cut off from the rest at a node's border, is farther away than the cell can tell.
  constexpr int kBorder = 32;
  for (int y = 0; y < kTileSamples; ++y) {
    for (int x = 0; x < kBorder; ++x) tile.disparity[static_cast<std::size_t>(y) * kTileSamples + x] = far(random);
    tile.cut_right[static_cast<std::size_t>(y) * kTileSamples + kBorder - 1] = 1;
  }
  const Tile decoded = *decode_tile(*encode_tile(tile, {}));
  expect_same(tile, decoded);
  for (int y = 0; y < kTileSamples; ++y)
    for (int x = 0; x < kBorder; ++x) ASSERT_FLOAT_EQ(decoded.disparity[static_cast<std::size_t>(y) * kTileSamples + x], 0.0f) << x << ", " << y;
}

TEST(TileCodec, DepthBeyondTheParallaxLimitCostsNothing) {
  // A slanted surface from half the tolerance to almost all of it, then from there to twice as much.
  const auto disparity_bytes = [](float first, float last) {
    Tile tile = dense_tile(9);
    std::fill(tile.coverage.begin(), tile.coverage.end(), 1);
    std::fill(tile.cut_right.begin(), tile.cut_right.end(), 0), std::fill(tile.cut_down.begin(), tile.cut_down.end(), 0);
    for (std::size_t i = 0; i < tile.samples(); ++i)
      tile.disparity[i] = tile.disparity_tolerance * (first + (last - first) * static_cast<float>(i % kTileSamples) / kTileSamples);
    TileBytes bytes;
    EXPECT_TRUE(encode_tile(tile, {}, &bytes));
    return bytes.disparity;
  };
  EXPECT_LE(disparity_bytes(0.5f, 0.99f), 8u);
  EXPECT_GT(disparity_bytes(1.0f, 2.0f), disparity_bytes(0.5f, 0.99f));
}

TEST(TileCodec, ContentIsWhatIsShownWhateverTheCell) {
  const auto content = [](const Tile& tile) {
    TileBytes bytes;
    EXPECT_TRUE(encode_tile(tile, {}, &bytes));
    return bytes.content;
  };
  const Tile tile = dense_tile(7);
  Tile elsewhere = tile, turned = tile, repainted = tile, nearer = tile;
  elsewhere.id.cell.x += 1, elsewhere.certificate.missed_void = true;
  turned.id.face = 3;
  for (std::uint8_t& c : repainted.rgb) c = static_cast<std::uint8_t>(c / 2);
  nearer.disparity[0] *= 1.1f;
  EXPECT_EQ(content(elsewhere), content(tile));
  EXPECT_NE(content(turned), content(tile)) << "shown in another direction";
  EXPECT_NE(content(repainted), content(tile));
  EXPECT_NE(content(nearer), content(tile));
}

TEST(TileCodec, InspectAgreesWithTheEncoder) {
  TileBytes written;
  const Bytes encoded = *encode_tile(dense_tile(7), {}, &written);
  const TileBytes read = *inspect_tile(encoded);
  EXPECT_EQ(read.colour, written.colour);
  EXPECT_EQ(read.disparity, written.disparity);
  EXPECT_EQ(read.topology, written.topology);
  EXPECT_EQ(read.covered_samples, written.covered_samples);
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/splats.h"

#include <gtest/gtest.h>

#include "common/math/cube_face.h"

namespace farfield {
namespace {

Tile dense_tile(int tiles, int x, int y) {
  Tile tile;
  tile.id = {CellId{}, kIntraView, 2, static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)};
  tile.edge_samples = face_samples(tiles);
  tile.width = tile.height = kTileSamples;
  tile.coverage.assign(tile.samples(), 1);
  tile.disparity.resize(tile.samples());
  tile.rgb.resize(3 * tile.samples());
  for (std::size_t k = 0; k < tile.samples(); ++k) {
    tile.disparity[k] = 0.001f * static_cast<float>(k % 97);
    tile.rgb[3 * k] = static_cast<std::uint8_t>(k), tile.rgb[3 * k + 1] = 7, tile.rgb[3 * k + 2] = 9;
  }
  tile.cut_right.assign(tile.samples(), 0);
  tile.cut_down.assign(tile.samples(), 0);
  return tile;
}

TEST(Splats, DenseTilesLeaveOutWhatOtherTilesHold) {
  const Splats splats = build_splats(dense_tile(3, 1, 0));
  const std::size_t rows = kTileStride + 1;  // at the face's upper end: nobody else holds row 0
  ASSERT_EQ(splats.runs.size(), rows);
  EXPECT_EQ(splats.size(), rows * kTileStride);
  const int n = face_samples(3);
  EXPECT_FLOAT_EQ(splats.runs[5].u0, static_cast<float>(sample_tangent(n, kTileStride + 1)));
  EXPECT_FLOAT_EQ(splats.runs[5].v, static_cast<float>(sample_tangent(n, 5)));
  EXPECT_FLOAT_EQ(splats.pitch, static_cast<float>(sample_pitch(n)));
  EXPECT_EQ(splats.face, 2);
  EXPECT_FLOAT_EQ(splats.max_disparity, 0.096f);
  EXPECT_FLOAT_EQ(splats.u_max, static_cast<float>(sample_tangent(n, 2 * kTileStride)));
}

TEST(Splats, TilesOfAFaceHoldEverySampleOnce) {
  std::size_t total = 0;
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) total += build_splats(dense_tile(2, x, y)).size();
  }
  EXPECT_EQ(total, static_cast<std::size_t>(face_samples(2)) * face_samples(2));
}

TEST(Splats, UncoveredSamplesSplitRuns) {
  Tile tile = dense_tile(1, 0, 0);
  tile.coverage[128 * 3 + 10] = 0;
  const Splats splats = build_splats(tile);
  ASSERT_EQ(splats.runs.size(), 129u);
  EXPECT_EQ(splats.runs[3].count, 10u);
  EXPECT_EQ(splats.runs[4].count, 117u);
  EXPECT_FLOAT_EQ(splats.runs[4].u0, static_cast<float>(sample_tangent(tile.edge_samples, 11)));
  EXPECT_FLOAT_EQ(splats.disparity[splats.runs[4].first], tile.disparity[128 * 3 + 11]);
  EXPECT_EQ(splats.colour[splats.runs[4].first], 0x090700u | tile.rgb[3 * (128 * 3 + 11)]);
}

TEST(Splats, RunsContinueAcrossAdjacentBlocks) {
  Tile tile;
  tile.id = {CellId{}, 1, 0, 0, 0};
  tile.edge_samples = 258;
  tile.blocks = {{3, 4}, {3, 5}, {4, 4}, {9, 4}};  // sorted by column, as the order of places is
  tile.width = kPackedColumns * kBlockSamples;
  tile.height = kBlockSamples;
  tile.coverage.assign(tile.samples(), 0);
  tile.disparity.assign(tile.samples(), 0.25f);
  tile.rgb.assign(3 * tile.samples(), 50);
  tile.cut_right.assign(tile.samples(), 0);
  tile.cut_down.assign(tile.samples(), 0);
  for (int b = 0; b < 4; ++b) {
    for (int k = 0; k < 64; ++k) tile.coverage[(k / 8) * tile.width + 8 * b + k % 8] = 1;
  }
  const Splats splats = build_splats(tile);
  EXPECT_EQ(splats.size(), 256u);
  ASSERT_EQ(splats.runs.size(), 24u);  // 8 rows of {3,4}+{4,4}, 8 of {9,4}, 8 of {3,5}
  EXPECT_EQ(splats.runs[0].count, 16u);
  EXPECT_EQ(splats.runs[1].count, 8u);
  EXPECT_FLOAT_EQ(splats.runs[1].u0, static_cast<float>(sample_tangent(258, 72)));
  EXPECT_FLOAT_EQ(splats.runs[0].v, static_cast<float>(sample_tangent(258, 32)));
}

float slope_u(const Splats& s, std::size_t k) { return std::bit_cast<float>(s.slopes[k] & 0xffff0000u); }
float slope_v(const Splats& s, std::size_t k) { return std::bit_cast<float>(s.slopes[k] << 16); }

TEST(Splats, SlopesAndColoursComeFromConnectedNeighboursOnly) {
  Tile tile = dense_tile(1, 0, 0);
  for (int j = 0; j < 128; ++j) {
    for (int i = 0; i < 128; ++i) tile.disparity[128 * j + i] = 0.25f + 0.0005f * i - 0.00025f * j + (i > 50 ? 0.3f : 0.0f);
  }
  for (int j = 0; j < 128; ++j) tile.cut_right[128 * j + 50] = 3;
  tile.cut_down[128 * 60 + 20] = 8;
  const Splats s = build_splats(tile);
  ASSERT_EQ(s.size(), 128u * 128u);  // one run per row: index as in the tile
  for (const std::size_t k : {128u * 40 + 30, 128u * 40 + 50, 128u * 40 + 51, 128u * 60 + 20, 128u * 127 + 127}) {
    EXPECT_NEAR(slope_u(s, k), 0.0005f, 0.0005f / 100);
    EXPECT_NEAR(slope_v(s, k), -0.00025f, 0.00025f / 100);
  }
  EXPECT_EQ(s.reach[128 * 40 + 30], pack_reach(10, 10, 10, 10));
  EXPECT_EQ(s.reach[128 * 40 + 50], pack_reach(10, 5, 10, 10));   // (3 - ½)/8 of the way
  EXPECT_EQ(s.reach[128 * 40 + 51], pack_reach(11, 10, 10, 10));  // and the rest
  EXPECT_EQ(s.reach[128 * 60 + 20], pack_reach(10, 10, 10, 15));
  EXPECT_EQ(s.reach[128 * 61 + 20], pack_reach(10, 10, 1, 10));
  EXPECT_EQ(s.reach[0], pack_reach(8, 10, 8, 10));
  EXPECT_EQ(s.colour_down[128 * 40 + 30], s.colour[128 * 41 + 30]);
  EXPECT_EQ(s.colour_up[128 * 40 + 30], s.colour[128 * 39 + 30]);
  EXPECT_EQ(s.colour_down[128 * 60 + 20], s.colour[128 * 60 + 20]);
  EXPECT_EQ(s.colour_up[128 * 61 + 20], s.colour[128 * 61 + 20]);
}

TEST(Splats, ConnectionsThatLeaveARunAreMarked) {
  const Splats s = build_splats(dense_tile(3, 1, 1));
  const SplatRun& run = s.runs[4];
  EXPECT_EQ(s.reach[run.first], pack_reach(kReachOutOfRun, 10, 10, 10));
  EXPECT_EQ(s.reach[run.first + 1], pack_reach(10, 10, 10, 10));
  EXPECT_EQ(s.reach[run.first + run.count - 1], pack_reach(10, kReachOutOfRun, 10, 10));
}

TEST(Splats, AnEmptyTileGivesNone) {
  Tile tile = dense_tile(1, 0, 0);
  tile.coverage.assign(tile.samples(), 0);
  EXPECT_EQ(build_splats(tile).size(), 0u);
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/splats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/impostor/tile_neighbours.h"
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
  EXPECT_EQ(splats.drawn, rows * kTileStride);
  EXPECT_EQ(splats.size(), std::size_t{kTileSamples} * kTileSamples) << "what is drawn, and its neighbours";
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
    for (int x = 0; x < 2; ++x) total += build_splats(dense_tile(2, x, y)).drawn;
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

/// Entries of the neighbours above and below of sample k.
std::size_t above(const Splats& s, std::size_t k) {
  const auto link = std::prev(std::upper_bound(s.links.begin(), s.links.end(), k,
                                               [](std::size_t at, const SplatLink& l) { return at < l.first; }));
  return k - link->up;
}
std::size_t below(const Splats& s, std::size_t k) {
  const auto link = std::prev(std::upper_bound(s.links.begin(), s.links.end(), k,
                                               [](std::size_t at, const SplatLink& l) { return at < l.first; }));
  return k + link->down;
}

TEST(Splats, ReachesEndAtCutsAndLinksLeadToNeighboursAlongV) {
  Tile tile = dense_tile(1, 0, 0);
  for (int j = 0; j < 128; ++j) tile.cut_right[128 * j + 50] = 3;
  tile.cut_down[128 * 60 + 20] = 8;
  const Splats s = build_splats(tile);
  ASSERT_EQ(s.size(), 128u * 128u);  // one run per row: index as in the tile
  EXPECT_EQ(s.reach[128 * 40 + 30], pack_reach(10, 10, 10, 10));
  EXPECT_EQ(s.reach[128 * 40 + 50], pack_reach(10, 5, 10, 10));   // (3 - ½)/8 of the way
  EXPECT_EQ(s.reach[128 * 40 + 51], pack_reach(11, 10, 10, 10));  // and the rest
  EXPECT_EQ(s.reach[128 * 60 + 20], pack_reach(10, 10, 10, 15));
  EXPECT_EQ(s.reach[128 * 61 + 20], pack_reach(10, 10, 1, 10));
  EXPECT_EQ(s.reach[0], pack_reach(8, 10, 8, 10));
  EXPECT_EQ(above(s, 128 * 40 + 30), 128u * 39 + 30);
  EXPECT_EQ(below(s, 128 * 40 + 30), 128u * 41 + 30);
  EXPECT_EQ(below(s, 128 * 126 + 30), 128u * 127 + 30);
}

// A far wall with a pillar before its columns 51 to 60, sloping by `slope` from column to column.
Tile wall_behind_pillar(float slope) {
  Tile tile = dense_tile(1, 0, 0);
  tile.disparity_tolerance = 0.001f;
  for (int j = 0; j < 128; ++j) {
    for (int i = 0; i < 128; ++i) tile.disparity[128 * j + i] = i > 50 && i <= 60 ? 0.3f : 0.2f + slope * static_cast<float>(i - 50);
    tile.cut_right[128 * j + 50] = 3, tile.cut_right[128 * j + 60] = 6;
  }
  return tile;
}

TEST(Splats, WhatANearerSurfaceHidesBeginsWithMoreOfTheFarther) {
  const Splats s = build_splats(wall_behind_pillar(0), false);
  ASSERT_EQ(s.size(), 128u * 128u);
  EXPECT_EQ(s.reach[128 * 40 + 50], pack_reach(10, kReachBehind, 10, 10));
  EXPECT_EQ(s.reach[128 * 40 + 51], pack_reach(11, 10, 10, 10)) << "the pillar ends where it was found to end";
  EXPECT_EQ(s.reach[128 * 40 + 60], pack_reach(10, 11, 10, 10));
  EXPECT_EQ(s.reach[128 * 40 + 61], pack_reach(kReachBehind, 10, 10, 10));
}

TEST(Splats, ASurfaceThatWouldRunBeforeTheNearerOneEndsAtItsCut) {
  const Splats s = build_splats(wall_behind_pillar(0.099f), false);  // at the pillar's column .299, and known to .004 only
  EXPECT_EQ(s.reach[128 * 40 + 50], pack_reach(10, 5, 10, 10));
  const Splats apart = build_splats(wall_behind_pillar(0.095f), false);
  EXPECT_EQ(apart.reach[128 * 40 + 50], pack_reach(10, kReachBehind, 10, 10));
}

TEST(Splats, SurfacesThatCodingMayHaveMovedApartEndAtTheirCut) {
  Tile tile = wall_behind_pillar(0);
  tile.disparity_tolerance = 0.03f;
  EXPECT_EQ(build_splats(tile, false).reach[128 * 40 + 50], pack_reach(10, 5, 10, 10));
}

// Whatever is covered and cut: who is connected finds exactly that neighbour's disparity and colour, and no link leads
// out of the arrays.
TEST(Splats, ConnectedSamplesFindTheirNeighboursInRaggedTiles) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    Tile tile;
    if (seed % 2 == 0) {
      tile = dense_tile(3, seed % 3, seed / 3 % 3);
    } else {
      tile.id.view = 1;
      tile.edge_samples = face_samples(2);
      for (std::uint16_t y = 0; y < 16; ++y) {
        for (std::uint16_t x = 0; x < 16; ++x) {
          if (random() % 3) tile.blocks.push_back({x, y});
        }
      }
      tile.width = packed_width(tile.blocks.size()), tile.height = packed_height(tile.blocks.size());
      ASSERT_TRUE(tile.is_packed());
    }
    const std::size_t samples = tile.samples();
    tile.coverage.assign(samples, 0), tile.cut_right.assign(samples, 0), tile.cut_down.assign(samples, 0);
    tile.disparity.resize(samples), tile.rgb.resize(3 * samples);
    const std::size_t used = tile.is_packed() ? tile.blocks.size() : samples;
    for (std::size_t i = 0; i < samples; ++i) {
      const std::size_t block = i / tile.width / kBlockSamples * kPackedColumns + i % tile.width / kBlockSamples;
      tile.coverage[i] = random() % 5 > 0 && (!tile.is_packed() || block < used);
      tile.disparity[i] = static_cast<float>(i + 1);  // names the sample
      tile.cut_right[i] = random() % 6 ? 0 : 4, tile.cut_down[i] = random() % 6 ? 0 : 4;
    }
    const Splats s = build_splats(tile);
    const TileNeighbours neighbours(tile);
    std::size_t connected = 0;
    for (std::size_t k = 0; k < s.size(); ++k) {
      ASSERT_LE(above(s, k), k);
      ASSERT_LT(below(s, k), s.size());
      const int index = static_cast<int>(s.disparity[k]) - 1;
      const auto expect = [&](int shift, int neighbour, const std::vector<std::uint8_t>& cuts, int before, std::size_t found) {
        const bool is_connected = neighbour >= 0 && tile.coverage[neighbour] && cuts[before] == kConnected;
        ASSERT_EQ((s.reach[k] >> shift & 15) == kReachConnected, is_connected) << seed << " " << k;
        if (!is_connected) return;
        ++connected;
        ASSERT_LT(found, s.size());
        ASSERT_EQ(s.disparity[found], tile.disparity[neighbour]) << seed << " " << k << " " << shift;
      };
      expect(0, neighbours.left(index), tile.cut_right, neighbours.left(index), k - 1);
      expect(4, neighbours.right(index), tile.cut_right, index, k + 1);
      expect(8, neighbours.up(index), tile.cut_down, neighbours.up(index), above(s, k));
      expect(12, neighbours.down(index), tile.cut_down, index, below(s, k));
    }
    EXPECT_GT(connected, s.size());
  }
}

TEST(Splats, ASampleTakesTenBytesAndNoCapacityIsSpare) {
  const Splats s = build_splats(dense_tile(3, 1, 1));
  const std::size_t blocks = 2 * 4 * SplatBlocks::kColumns * (SplatBlocks::kColumns + 1) + 4 * (SplatBlocks::kColumns + 1);
  EXPECT_LE(s.memory_bytes(), 10 * s.size() + 24 * 128 + blocks);  // runs and links: one per row
  EXPECT_EQ(s.runs.capacity(), s.runs.size());
  EXPECT_EQ(s.links.capacity(), s.links.size());
}

TEST(Splats, BlocksHoldEverySampleAndItsSlopes) {
  Tile tile = dense_tile(2, 1, 0);
  std::mt19937 random(5);
  for (auto& covered : tile.coverage) covered = random() % 8 != 0;
  const Splats s = build_splats(tile);
  const SplatBlocks& blocks = s.blocks;
  ASSERT_EQ(blocks.edge, 8);
  ASSERT_EQ(blocks.first_run.size(), static_cast<std::size_t>(blocks.rows) + 1);
  EXPECT_EQ(blocks.first_run.back(), s.runs.size());
  std::size_t held = 0;
  for (int j = 0; j < blocks.rows; ++j) {
    for (std::uint32_t r = blocks.first_run[j]; r < blocks.first_run[j + 1]; ++r, ++held) {
      const SplatRun& run = s.runs[r];
      EXPECT_NEAR(run.v, s.v_min + s.pitch * (8 * static_cast<float>(j) + 3.5f), 4 * s.pitch);
      for (std::uint32_t i = 0; i < run.count; ++i) {
        const int column = first_column(s, run) + static_cast<int>(i);
        ASSERT_NEAR(s.u_min + static_cast<float>(column) * s.pitch, run.u0 + static_cast<float>(i) * s.pitch, 1e-5f);
        const std::size_t block = static_cast<std::size_t>(j * SplatBlocks::kColumns + column / 8);
        const std::uint32_t at = run.first + i;
        const bool has_right = (s.reach[at] >> 4 & 15) == kReachConnected;
        const float slope = has_right ? std::abs(s.disparity[at + 1] - s.disparity[at]) : 0;
        ASSERT_LE(blocks.lowest[block], s.disparity[at] - slope);
        ASSERT_GE(blocks.highest[block], s.disparity[at] + slope);
      }
    }
  }
  EXPECT_EQ(held, s.runs.size());
}

TEST(Splats, BlocksOfScatteredSamplesTakeNoMoreMemory) {
  Tile tile;
  tile.edge_samples = face_samples(40);
  tile.blocks = {{0, 0}, {600, 3}, {2, 600}};
  tile.width = packed_width(3), tile.height = packed_height(3);
  tile.coverage.assign(tile.samples(), 1);
  tile.disparity.assign(tile.samples(), 0.1f);
  tile.rgb.assign(3 * tile.samples(), 9);
  tile.cut_right.assign(tile.samples(), 0), tile.cut_down.assign(tile.samples(), 0);
  tile.id.view = 1;
  const Splats s = build_splats(tile);
  EXPECT_EQ(s.drawn, 3u * kBlockSamples * kBlockSamples);
  EXPECT_EQ(s.blocks.edge, 601 * kBlockSamples / SplatBlocks::kColumns + 1);
  EXPECT_LE(s.blocks.lowest.size(), static_cast<std::size_t>(SplatBlocks::kColumns) * (SplatBlocks::kColumns + 1));
  const auto held = [](float highest) { return highest > 0; };
  EXPECT_EQ(std::count_if(s.blocks.highest.begin(), s.blocks.highest.end(), held), 3 + 2) << "in two rows";
}

TEST(Splats, AnEmptyTileGivesNone) {
  Tile tile = dense_tile(1, 0, 0);
  tile.coverage.assign(tile.samples(), 0);
  EXPECT_EQ(build_splats(tile).size(), 0u);
}

}  // namespace
}  // namespace farfield

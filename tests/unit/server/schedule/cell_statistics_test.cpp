// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/cell_statistics.h"

#include <gtest/gtest.h>

namespace farfield {
namespace {

EncodedTile tile_of(std::size_t bytes, double seconds, double intra_seconds) {
  EncodedTile tile;
  tile.bytes = std::make_shared<const Bytes>(bytes);
  tile.seconds = seconds;
  tile.stages.intra = intra_seconds;
  tile.covered_samples = 100;
  tile.colour_bytes = static_cast<std::uint32_t>(bytes / 2);
  return tile;
}

TEST(CellStatistics, AddsUpACellsOwnTilesAndKeepsTheFallbackViewApart) {
  CellStatisticsRecorder recorder;
  const CellId leaf{.level = 1, .x = 5};
  recorder.add_plan({.leaf = leaf, .seconds = 0.5});
  recorder.add_tile({.cell = leaf}, tile_of(1000, 0.02, 0.005));
  recorder.add_tile({.cell = leaf, .view = 1}, tile_of(500, 0.03, 0));
  recorder.add_tile({.cell = leaf, .view = 2}, tile_of(0, 0.01, 0));
  recorder.add_tile({.cell = leaf, .view = kFallbackView}, tile_of(300, 0.04, 0.01));
  recorder.add_tile({.cell = leaf.parent()}, tile_of(7, 1, 1));
  const auto cells = recorder.cells();
  ASSERT_EQ(cells.size(), 2u);
  const CellStatistics& own = cells[0].cell == leaf ? cells[0] : cells[1];
  EXPECT_TRUE(own.is_leaf);
  EXPECT_DOUBLE_EQ(own.seconds, 0.06);
  EXPECT_DOUBLE_EQ(own.stages.intra, 0.005);
  EXPECT_DOUBLE_EQ(own.fallback_seconds, 0.04);
  EXPECT_DOUBLE_EQ(own.visibility_seconds, 0.5);
  EXPECT_EQ(own.tiles, 2u);
  EXPECT_EQ(own.empty_tiles, 1u);
  EXPECT_EQ(own.bytes, 1500u);
  EXPECT_EQ(own.colour_bytes, 750u);
  EXPECT_EQ(own.covered_samples, 300u);
  EXPECT_EQ(recorder.tile_seconds().count, 5u);
}

TEST(CellStatistics, AddsUpWhatWasSkippedAndRemembersTheLastPlan) {
  CellStatisticsRecorder recorder;
  const CellId leaf{.level = 1, .x = 5};
  EncodedTile tile = tile_of(1000, 0.02, 0.005);
  tile.rays = 7;
  tile.skips = {.samples_coloured_once = 1, .hidden_samples = 2, .delta_blocks_hidden = 3, .delta_blocks_not_cast = 4, .delta_samples_held = 5};
  recorder.add_tile({.cell = leaf}, tile);
  recorder.add_tile({.cell = leaf, .view = 1}, tile);
  recorder.add_tile({.cell = leaf, .view = kFallbackView}, tile);
  for (const std::uint32_t triangles : {10u, 20u})
    recorder.add_plan({.leaf = leaf, .chunks = {1, 2, 3}, .near_triangles = triangles, .skips = {.tiles_unseen = 8, .chunks_unseen = 9}, .delta_views = 6});
  const CellStatistics cell = recorder.cells().at(0);
  EXPECT_EQ(cell.rays, 14u);
  EXPECT_EQ(cell.skipped.samples_coloured_once, 2u);
  EXPECT_EQ(cell.skipped.hidden_samples, 4u);
  EXPECT_EQ(cell.skipped.delta_blocks_hidden, 6u);
  EXPECT_EQ(cell.skipped.delta_blocks_not_cast, 8u);
  EXPECT_EQ(cell.skipped.delta_samples_held, 10u);
  EXPECT_EQ(cell.left_out.tiles_unseen, 8u) << "of the last plan alone";
  EXPECT_EQ(cell.left_out.chunks_unseen, 9u);
  EXPECT_EQ(cell.near_triangles, 20u);
  EXPECT_EQ(cell.chunks, 3u);
  EXPECT_EQ(cell.delta_views, 6);
}

TEST(CellStatistics, IsBounded) {
  CellStatisticsRecorder recorder(2);
  for (int x = 0; x < 5; ++x) recorder.add_tile({.cell = {.x = x}}, tile_of(1, 1, 0));
  recorder.add_tile({.cell = {.x = 0}}, tile_of(1, 1, 0));
  EXPECT_EQ(recorder.cells().size(), 2u);
  EXPECT_EQ(recorder.cells()[0].tiles, 2u);
  EXPECT_EQ(recorder.dropped(), 3u);
}

TEST(DurationHistogram, CountsByRange) {
  DurationHistogram histogram;
  for (double seconds : {0.0001, 0.0005, 0.0006, 1.5, 99.0}) histogram.add(seconds);
  EXPECT_EQ(histogram.counts.front(), 2u);
  EXPECT_EQ(histogram.counts[1], 1u);
  EXPECT_EQ(histogram.counts.back(), 1u);
  EXPECT_EQ(histogram.count, 5u);
  EXPECT_DOUBLE_EQ(histogram.max_s, 99.0);
  EXPECT_NEAR(histogram.mean_s(), 100.5012 / 5, 1e-12);
}

}  // namespace
}  // namespace farfield

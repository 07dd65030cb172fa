// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/bench/skip_savings.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield::bench {
namespace {

using testing::HasSubstr;

CellStatistics leaf_at(int x) {
  CellStatistics cell;
  cell.cell = {.level = 1, .x = x, .y = -2, .z = 3};
  cell.is_leaf = true;
  cell.tiles = 40, cell.empty_tiles = 2, cell.rays = 5000, cell.seconds = 0.25, cell.bytes = 9000, cell.delta_views = 3;
  cell.skipped = {.samples_coloured_once = 11, .hidden_samples = 12, .delta_blocks_hidden = 13, .delta_blocks_not_cast = 14,
                  .delta_samples_held = 15, .samples_without_depth = 16, .identical_tiles = 17};
  cell.left_out = {.tiles_unseen = 21, .tiles_too_small = 22, .chunks_facing_away = 23, .chunks_unseen = 24, .triangles_unseen = 25,
                   .blocked_cells = 1};
  cell.chunks = 26, cell.near_triangles = 27;
  return cell;
}

TEST(Explain, EveryCountOfACellIsInItsJson) {
  MethodResult method;
  method.name = "farfield-cpu";
  method.explained = {leaf_at(7)};
  const nlohmann::json cell = explain_json(std::span(&method, 1)).at(0);
  EXPECT_EQ(cell.at("method"), "farfield-cpu");
  EXPECT_EQ(cell.at("cell"), (nlohmann::json{{"level", 1}, {"x", 7}, {"y", -2}, {"z", 3}}));
  EXPECT_EQ(cell.at("is_leaf"), true);
  EXPECT_EQ(cell.at("is_blocked"), true);
  EXPECT_EQ(cell.at("delta_views"), 3);
  EXPECT_EQ(cell.at("bytes"), 9000);
  EXPECT_DOUBLE_EQ(cell.at("ms").get<double>(), 250);
  EXPECT_EQ(cell.at("tiles"), (nlohmann::json{{"made", 40}, {"empty", 2}, {"unseen", 21}, {"too_small", 22}, {"identical", 17}}));
  EXPECT_EQ(cell.at("samples"), (nlohmann::json{{"cast", 5000}, {"hidden", 12}, {"coloured_once", 11}, {"without_depth", 16}, {"held", 15}}));
  EXPECT_EQ(cell.at("delta_blocks"), (nlohmann::json{{"hidden", 13}, {"not_cast", 14}}));
  EXPECT_EQ(cell.at("chunks"), (nlohmann::json{{"listed", 26}, {"facing_away", 23}, {"unseen", 24}, {"triangles", 27}, {"triangles_unseen", 25}}));
}

TEST(Explain, LeavesComeFirstAndTheListIsBounded) {
  std::vector<CellStatistics> cells;
  for (int x = 400; x-- > 0;) {
    cells.push_back(leaf_at(x));
    cells.back().is_leaf = x >= 300;
  }
  const std::vector<CellStatistics> kept = explained_cells(cells);
  ASSERT_EQ(kept.size(), kMostExplained);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(kept[static_cast<std::size_t>(k)].cell.x, 300 + k);
  EXPECT_EQ(kept[100].cell.x, 0);
  EXPECT_FALSE(kept[100].is_leaf);
}

TEST(Explain, TheTableHasALinePerCellAndSaysWhy) {
  MethodResult method;
  method.name = "farfield-cpu";
  std::ostringstream nothing, out;
  print_explanation(method, nothing);
  EXPECT_EQ(nothing.str(), "") << "not asked for";
  method.explained = {leaf_at(7), leaf_at(8)};
  method.savings = {{"empty tiles: not sent", "empty_tiles", 2, kNone, kNone, 1500}};
  print_explanation(method, out);
  EXPECT_THAT(out.str(), HasSubstr("L1 7,-2,3 *"));
  EXPECT_THAT(out.str(), HasSubstr("L1 8,-2,3 *"));
  EXPECT_THAT(out.str(), HasSubstr("near geometry hides them"));
  EXPECT_THAT(out.str(), HasSubstr("empty tiles: not sent"));
  EXPECT_THAT(out.str(), HasSubstr("1.5\n"));
}

TEST(SkipSavings, PriceWhatASmallSceneSkips) {
  World world;
  test::Blocks blocks;
  blocks.room({{-24, -2, -24}, {24, 8, 24}}, {180, 190, 170, 255}, 6);
  for (int z = -3; z <= 3; ++z)
    for (int x = 0; x <= 3; ++x) blocks.box({{6 * x, -2, 6 * z}, {6 * x + 1, 8, 6 * z + 1}}, {140, 80, 70, 255}, 3);
  const test::PlacedScene placed = blocks.build();
  world.scene = placed.scene;
  ImpostorSettings settings;
  settings.display = {320, 180};
  settings.face_tiles = 3, settings.delta_views = 3, settings.near_triangles = 300;
  const NestedShells shells{CellGrid{settings.finest_side_m}, settings.kappa};
  CellTree tree(placed.scene, shells, settings.near_triangles);
  MethodResult result;
  CellStatistics cell;
  cell.cell = tree.leaf_at(placed.at({3.5, 0, 3.5}), nullptr).value(), cell.is_leaf = true, cell.seconds = 0.5, cell.visibility_seconds = 0.25;
  result.explained = {cell};
  result.skipped = {{"empty_tiles", 3}, {"hidden_samples", 1e6}, {"samples_coloured_once", 2e5},
                    {"leaves_blocked_ahead", 2}, {"payload_bytes_held", 12345}, {"payloads_held", 7}};
  const std::vector<Saving> savings = measure_savings(world, settings, result);
  const auto of = [&](const std::string& counter) {
    for (const Saving& saving : savings)
      if (saving.counter == counter) return saving;
    ADD_FAILURE() << counter;
    return Saving{};
  };
  EXPECT_GT(of("empty_tiles").bytes, 3 * 40) << "headers alone";
  EXPECT_DOUBLE_EQ(of("hidden_samples").rays, 1e6);
  EXPECT_DOUBLE_EQ(of("samples_coloured_once").rays, 8e5);
  EXPECT_GT(of("samples_coloured_once").ms, 0);
  EXPECT_DOUBLE_EQ(of("leaves_blocked_ahead").ms, 1500);
  EXPECT_DOUBLE_EQ(of("payloads_held").bytes, 12345);
  EXPECT_GT(of("tiles_unseen").count, 0);
  EXPECT_GT(of("tiles_unseen").ms, 0);
}

}  // namespace
}  // namespace farfield::bench

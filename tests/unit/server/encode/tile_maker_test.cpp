// SPDX-License-Identifier: Apache-2.0
#include "server/encode/tile_maker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "common/codec/tile_codec.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::PlacedScene;

ImpostorSettings small_settings() {
  ImpostorSettings settings;
  settings.display = {320, 180};
  settings.face_tiles = 3;
  settings.delta_views = 3;
  settings.near_triangles = 300;
  return settings;
}

// A hall with pillars on one side only, so that the cell tree divides and shells have something to hide.
PlacedScene pillared_hall() {
  test::Blocks blocks;
  blocks.room({{-24, -2, -24}, {24, 8, 24}}, {180, 190, 170, 255}, 6);
  for (int z = -3; z <= 3; ++z)
    for (int x = 0; x <= 3; ++x) blocks.box({{6 * x, -2, 6 * z}, {6 * x + 1, 8, 6 * z + 1}}, {140, 80, 70, 255}, 3);
  return blocks.build();
}

class TileMakerTest : public testing::Test {
 protected:
  static const PlacedScene& placed() {
    static const PlacedScene scene = pillared_hall();
    return scene;
  }
  static ImpostorSources sources() { return make_impostor_sources(placed().scene, small_settings()); }
  // Some dense and some delta tiles that a viewer needs.
  static std::vector<TileId> some_tiles(const ImpostorSources& sources) {
    const CellId leaf = sources.leaves->leaf_at(placed().at({3.5, 0, 3.5}), nullptr).value();
    const auto plan = sources.leaves->plan(leaf, nullptr).value();
    std::vector<TileId> ids;
    int dense = 0, delta = 0;
    for (const NeededTile& tile : plan->tiles)
      if ((tile.id.is_delta() ? delta : dense)++ < 4) ids.push_back(tile.id);
    EXPECT_GE(dense, 4);
    EXPECT_GE(delta, 1) << "the scene should need delta views";
    const auto fallback = sources.leaves->fallback(placed().at({3.5, 0, 3.5}));
    for (int i = 0; i < 2; ++i) ids.push_back(fallback->tiles.at(i).id);
    return ids;
  }
  static std::vector<Bytes> make_all(TileMaker& maker, const std::vector<TileId>& ids) {
    std::vector<Bytes> made;
    for (const TileId& id : ids) made.push_back(*maker.make(id, nullptr).value()->bytes);
    return made;
  }
};

TEST_F(TileMakerTest, BytesDependOnNothingButTheTile) {
  const ImpostorSources first = sources(), second = sources();
  const std::vector<TileId> ids = some_tiles(first);
  const std::vector<Bytes> once = make_all(*first.tiles, ids);
  EXPECT_EQ(once, make_all(*first.tiles, ids)) << "made again";
  std::vector<TileId> reversed(ids.rbegin(), ids.rend());
  std::vector<Bytes> elsewhere = make_all(*second.tiles, reversed);
  std::reverse(elsewhere.begin(), elsewhere.end());
  EXPECT_EQ(once, elsewhere) << "by another maker, in another order";
  std::vector<Bytes> a, b;
  std::thread other([&] { a = make_all(*second.tiles, ids); });
  b = make_all(*second.tiles, ids);
  other.join();
  EXPECT_EQ(once, a) << "by two threads at once";
  EXPECT_EQ(once, b) << "by two threads at once";
}

TEST_F(TileMakerTest, TilesDecodeToWhatWasCastAndCarryTheirCertificate) {
  const ImpostorSources made = sources();
  int measured = 0;
  for (const TileId& id : some_tiles(made)) {
    const auto encoded = made.tiles->make(id, nullptr).value();
    if (encoded->bytes->empty()) continue;
    EXPECT_EQ(encoded->hash, hash_bytes(*encoded->bytes));
    TileWork work;
    const Tile exact = made.tiles->cast(id, nullptr, work).value();
    const Tile decoded = decode_tile(*encoded->bytes).value();
    EXPECT_EQ(decoded.id, id);
    EXPECT_EQ(decoded.coverage, exact.coverage);
    EXPECT_EQ(encoded->covered_samples, static_cast<std::size_t>(std::count(exact.coverage.begin(), exact.coverage.end(), 1)));
    for (std::size_t k = 0; k < exact.samples(); ++k) {
      if (exact.coverage[k]) { ASSERT_NEAR(decoded.disparity[k], exact.disparity[k], exact.disparity_tolerance * 1.001); }
    }
    EXPECT_LE(decoded.certificate.disparity_p99, decoded.disparity_tolerance * 1.001f);
    measured += decoded.certificate.colour_mse[0] >= 0;
    EXPECT_EQ(decoded.certificate.colour_mse[0] >= 0, id.view != kFallbackView) << "every tile is measured";
    EXPECT_EQ(decoded.certificate.disparity_p99 >= 0, id.view != kFallbackView);
    if (id.view == kFallbackView) continue;
    EXPECT_GT(decoded.certificate.void_rays, 10000);
    EXPECT_LE(decoded.certificate.void_hits, decoded.certificate.void_rays / 100);
    EXPECT_LE(decoded.certificate.void_worst_hits, decoded.certificate.void_hits);
  }
  EXPECT_GE(measured, 1);
}

TEST_F(TileMakerTest, CancelledAndUnknownTilesAreErrors) {
  const ImpostorSources made = sources();
  TileId id = some_tiles(made)[0];
  const auto refused = made.tiles->make(id, std::make_shared<const std::atomic<bool>>(true));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCancelled);
  id.view = 200;
  const auto unknown = made.tiles->make(id, nullptr);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
}

TEST_F(TileMakerTest, TheFallbackViewShowsEverythingBeyondItsNearRegion) {
  const ImpostorSources made = sources();
  const auto plan = made.leaves->fallback(placed().at({3.5, 0, 3.5}));
  const CellGrid grid{small_settings().finest_side_m};
  const Box cell = grid.box(plan->leaf);
  const Box region = NestedShells{grid}.fallback_region(plan->leaf);
  const Box hall = placed().at(Box{{-24, -2, -24}, {24, 8, 24}});
  ASSERT_TRUE(plan->is_fallback);
  ASSERT_TRUE(cell.contains(placed().at({3.5, 0, 3.5})));
  ASSERT_EQ(plan->tiles.size(), 6u);
  std::size_t nearer = 0;
  for (const NeededTile& needed : plan->tiles) {
    const TileId& id = needed.id;
    const Tile tile = decode_tile(*made.tiles->make(id, nullptr).value()->bytes).value();
    const CubeFace face = CubeFace::of(id.face);
    ASSERT_EQ(static_cast<std::size_t>(std::count(tile.coverage.begin(), tile.coverage.end(), 1)), tile.samples());
    for (int j = 0; j < tile.height; ++j)
      for (int i = 0; i < tile.width; ++i) {
        const glm::dvec3 direction = face.direction(sample_tangent(tile.edge_samples, i), sample_tangent(tile.edge_samples, j));
        const double shown = tile.disparity[static_cast<std::size_t>(j) * tile.width + i];
        const double walls = grid.side_m(plan->leaf.level) / exit_distance(hall, cell.center(), direction);
        const double box = grid.side_m(plan->leaf.level) / exit_distance(region, cell.center(), direction);
        ASSERT_GE(shown, walls - 1.01 * tile.disparity_tolerance) << "nothing lies beyond the walls";
        ASSERT_LE(shown, box + 1.01 * tile.disparity_tolerance) << "nor inside the region";
        nearer += shown > 1.1 * walls;
      }
  }
  EXPECT_GT(nearer, 0u) << "the pillars";
}

TEST_F(TileMakerTest, CountsWhatItLeftOut) {
  const ImpostorSources made = sources();
  EXPECT_EQ(made.tiles->skips().hidden_samples, 0u);
  make_all(*made.tiles, some_tiles(made));
  const TileSkips skips = made.tiles->skips();
  EXPECT_GT(skips.delta_blocks_not_cast, 0u);
  EXPECT_GT(skips.delta_samples_held, 0u);
  EXPECT_GT(skips.samples_coloured_once, 0u);
}

TEST_F(TileMakerTest, EveryTileCarriesItsOwnCountsAndTheyAddUp) {
  const ImpostorSources made = sources();
  const CellId leaf = made.leaves->leaf_at(placed().at({3.5, 0, 3.5}), nullptr).value();
  TileSkips sum;
  const SharedPlan plan = made.leaves->plan(leaf, nullptr).value();
  for (const NeededTile& needed : plan->tiles) {
    if (needed.id.cell != leaf) continue;
    const auto tile = made.tiles->make(needed.id, nullptr).value();
    if (needed.id.is_delta()) {
      EXPECT_EQ(tile->skips.hidden_samples, 0u);
      EXPECT_LE(tile->skips.delta_blocks_hidden + tile->skips.delta_blocks_not_cast, std::uint64_t{kRegionBlocks} * kRegionBlocks);
      EXPECT_GE(tile->rays, tile->covered_samples);
    } else {
      EXPECT_EQ(tile->skips.hidden_samples + tile->rays, std::uint64_t{kTileSamples} * kTileSamples) << "cast or hidden";
    }
    EXPECT_LE(tile->skips.samples_coloured_once, tile->covered_samples);
    EXPECT_EQ(tile->skips.empty_tiles, tile->bytes->empty() ? 1u : 0u);
    sum += tile->skips;
  }
  const TileSkips total = made.tiles->skips();
  EXPECT_EQ(total.hidden_samples, sum.hidden_samples);
  EXPECT_EQ(total.delta_blocks_hidden, sum.delta_blocks_hidden);
  EXPECT_EQ(total.delta_blocks_not_cast, sum.delta_blocks_not_cast);
  EXPECT_EQ(total.samples_coloured_once, sum.samples_coloured_once);
  EXPECT_GT(sum.hidden_samples, 0u) << "pillars hide some of the shell from everywhere in the leaf";
  EXPECT_GT(sum.delta_blocks_hidden, 0u);
}

TEST(TileMaker, CellsAboveAnEndlessFloorShowTheSame) {
  // One colour, and the same under every cell: neighbours' tiles differ in their names alone.
  const PlacedScene placed = test::Blocks().quad({-400, -3, 400}, {800, 0, 0}, {0, 0, -800}, {90, 90, 90, 255}).build();
  const ImpostorSources made = make_impostor_sources(placed.scene, small_settings());
  const CellGrid grid{small_settings().finest_side_m};
  const CellId cell = grid.cell_at(placed.at({10.2, -1.4, 10.2}), 0);  // the floor lies in its shell
  constexpr int kDown = 3;  // -y
  const auto below = [&](int steps) {
    TileId id{cell, kIntraView, kDown, 1, 1};
    id.cell.x += steps;
    return made.tiles->make(id, nullptr).value();
  };
  EXPECT_EQ(below(0)->skips.identical_tiles, 0u) << "the first of its kind";
  EXPECT_EQ(below(0)->skips.identical_tiles, 0u) << "made again";
  const auto beside = below(1);
  ASSERT_FALSE(beside->bytes->empty());
  EXPECT_EQ(beside->skips.identical_tiles, 1u);
  EXPECT_EQ(beside->skips.identical_bytes, beside->bytes->size());
  EXPECT_EQ(made.tiles->skips().identical_tiles, 1u);
}

TEST(TileMaker, OnlyWhatIsFarAgainstTheCellGoesWithoutDepth) {
  // A wall 600 m away: against the fallback view's small cell it stands still, in the shell of a large cell it does not.
  ImpostorSettings settings = small_settings();
  settings.display = {64, 36};
  const PlacedScene placed = test::Blocks().quad({600, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 160, 170, 255}).quad({0, -40, -3}, {0, 0, 6}, {0, 6, 0}, {9, 99, 9, 255}, 16).build();
  const ImpostorSources made = make_impostor_sources(placed.scene, settings);
  const auto plan = made.leaves->fallback(placed.at({0.3, -39, 0.3}));
  std::uint64_t without = 0, covered = 0;
  for (const NeededTile& tile : plan->tiles) {
    const auto encoded = made.tiles->make(tile.id, nullptr).value();
    without += encoded->skips.samples_without_depth, covered += encoded->covered_samples;
  }
  EXPECT_GT(without, 0u);
  EXPECT_LE(without, covered);
  const CellId leaf = made.leaves->leaf_at(placed.at({0.3, -39, 0.3}), nullptr).value();
  const SharedPlan shells = made.leaves->plan(leaf, nullptr).value();
  for (const NeededTile& tile : shells->tiles) EXPECT_EQ(made.tiles->make(tile.id, nullptr).value()->skips.samples_without_depth, 0u);
}

TEST(TileMaker, ATileOfAnEmptyShellHasNoBytes) {
  const PlacedScene placed = test::Blocks().quad({5, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 160, 170, 255}).build();
  const ImpostorSources made = make_impostor_sources(placed.scene, small_settings());
  const CellId leaf = made.leaves->leaf_at(placed.at(glm::dvec3(4.5, 1, 1)), nullptr).value();
  // A leaf whose near region holds all there is has an empty shell in every direction.
  CellId cell = leaf;
  while (!NestedShells{CellGrid{small_settings().finest_side_m}, small_settings().kappa}.near_region(cell).contains(placed.scene->bounds())) cell = cell.parent();
  for (int face = 0; face < kCubeFaces; ++face) {
    const auto tile = made.tiles->make({cell, kIntraView, static_cast<std::uint8_t>(face), 1, 1}, nullptr);
    ASSERT_TRUE(tile);
    ASSERT_TRUE((*tile)->bytes);
    EXPECT_TRUE((*tile)->bytes->empty());
    EXPECT_EQ((*tile)->covered_samples, 0u);
  }
  EXPECT_EQ(made.tiles->skips().empty_tiles, 6u);
}

TEST(FinestSide, IsAPowerOfTwoAndFitsSmallScenes) {
  const PlacedScene large = test::Blocks().quad({0, 0, 0}, {500, 0, 0}, {0, 0, 500}, {9, 99, 99, 255}).build();
  const PlacedScene small = test::Blocks().quad({0, 0, 0}, {0.25f, 0, 0}, {0, 0, 0.25f}, {9, 99, 99, 255}).build();
  EXPECT_DOUBLE_EQ(finest_side_for(*large.scene, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(finest_side_for(*large.scene, 0.7), 0.5);
  EXPECT_DOUBLE_EQ(finest_side_for(*small.scene, 0.5), 0.25 / 64);
}

TEST(DirectionMask, HoldsWhatWasInsertedAndSurvivesItsBytes) {
  DirectionMask mask;
  EXPECT_FALSE(mask.contains({1, 0, 0}));
  mask.insert({3, 0.1, 0.2});
  mask.insert({-0.2, -0.3, -0.9});
  EXPECT_TRUE(mask.contains({6, 0.2, 0.4})) << "length does not matter";
  EXPECT_FALSE(mask.contains({-3, 0.1, 0.2}));
  const DirectionMask copy = DirectionMask::from_bytes(mask.bytes());
  EXPECT_TRUE(std::equal(copy.bytes().begin(), copy.bytes().end(), mask.bytes().begin(), mask.bytes().end()));
  EXPECT_TRUE(copy.contains({-0.2, -0.3, -0.9}));
  EXPECT_FALSE(copy.contains({0, 1, 0}));
  EXPECT_TRUE(DirectionMask::from_bytes(mask.bytes().subspan(1)).contains({0, 1, 0})) << "bytes of another length: all directions";
  EXPECT_TRUE(DirectionMask::all().contains({0, -1, 0.5}));
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// LeafSets under memory pressure: the order in which things are given up, and that there is progress under any cap.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "client/store/leaf_sets.h"
#include "tests/unit/client/store/made_leaf_sets.h"

namespace farfield::client {
namespace {

using ::testing::IsEmpty;

std::vector<std::uint64_t> serials(const LeafView& view) {
  std::vector<std::uint64_t> all;
  for (const auto& tile : view.tiles) all.push_back(tile->serial);
  return all;
}

TEST(LeafSetsMemory, FinestLevelsOfLargeTexturesGoBeforeTiles) {
  const std::size_t coarse = sizeof(TextureLevel) + 4 * 16 * 16;
  const std::size_t fine = sizeof(TextureLevel) + 4 * 32 * 32;
  LeafSets sets(made::frame(), 2 * made::kTileBytes + coarse + fine + 10);
  LeafSet set = made::leaf_set(1, 0, {1, 2, 3});
  set.chunks = {{20, 30}};
  sets.set_eye(made::eye_in(0));
  sets.announce(set);
  sets.receive(made::chunk(20));
  sets.receive(made::texture_level(30, 1, 16));
  sets.receive(made::texture_level(30, 0, 32));
  sets.receive(made::tile(1));
  sets.receive(made::tile(2));  // has room only without the finest level
  sets.update(true);
  EXPECT_EQ(sets.view()->tiles.size(), 2u);
  ASSERT_EQ(sets.view()->chunks.size(), 1u);
  EXPECT_EQ(sets.view()->chunks[0].texture->levels.size(), 1u);
  EXPECT_LE(sets.store().size_bytes(), sets.store().budget_bytes());
  EXPECT_THAT(sets.take_evicted(), IsEmpty()) << "the server would send it again at once";
}

// A dense scene's tiles once took 99 % of the budget, and the floor beside the viewer lost its texture to them.
TEST(LeafSetsMemory, SmallTexturesStayHoweverLargeTilesAre) {
  const std::size_t levels = 2 * sizeof(TextureLevel) + 4 * 4 * 4 + 4 * 8 * 8;
  LeafSets sets(made::frame(), 6 * made::kTileBytes + levels);
  LeafSet set = made::leaf_set(1, 0, {1, 2, 3, 4, 5, 6, 7, 8});
  set.chunks = {{20, 30}};
  sets.set_eye(made::eye_in(0));
  sets.announce(set);
  sets.receive(made::chunk(20));
  sets.receive(made::texture_level(30, 1, 4));
  for (const ContentHash key : {8, 7, 6, 5, 4, 3, 2, 1}) sets.receive(made::tile(key));
  sets.receive(made::texture_level(30, 0, 8));  // last, as the server sends it
  sets.update(true);
  ASSERT_EQ(sets.view()->chunks.size(), 1u);
  EXPECT_EQ(sets.view()->chunks[0].texture->levels.size(), 2u);
  EXPECT_EQ(sets.view()->tiles.size(), 5u);
  for (const ContentHash near : {1, 2, 3, 4, 5}) EXPECT_TRUE(sets.store().contains(near));
}

TEST(LeafSetsMemory, ANewLevelDisplacesAFarTileAndATileNeverALevel) {
  const std::size_t coarse = sizeof(TextureLevel) + 4 * 4 * 4;
  LeafSets sets(made::frame(), 8 * made::kTileBytes + coarse);
  LeafSet set = made::leaf_set(1, 0, {1, 2, 3, 4, 5, 6, 7, 8, 9});
  set.chunks = {{20, 30}};
  sets.set_eye(made::eye_in(0));
  sets.announce(set);
  sets.receive(made::chunk(20));
  sets.receive(made::texture_level(30, 1, 4));
  for (ContentHash key = 1; key <= 7; ++key) sets.receive(made::tile(key));
  sets.receive(made::texture_level(30, 0, 8));
  EXPECT_FALSE(sets.store().contains(7));
  for (const ContentHash key : {8, 9}) sets.receive(made::tile(key));
  EXPECT_TRUE(sets.store().contains_level(30, 0));
  EXPECT_TRUE(sets.store().contains(6));
  EXPECT_FALSE(sets.store().contains(8));
}

TEST(LeafSetsMemory, DeltaTilesGoBeforeWhatTheyAmend) {
  LeafSets sets(made::frame(), 3 * made::kTileBytes);
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2, 3, 4, 5}));  // 2 and 4 are delta tiles
  for (const ContentHash key : {1, 2, 3, 4, 5}) sets.receive(key % 2 ? made::tile(key) : made::delta_tile(key));
  for (const ContentHash key : {1, 3, 5}) EXPECT_TRUE(sets.store().contains(key)) << key;
  for (const ContentHash key : {2, 4}) EXPECT_FALSE(sets.store().contains(key)) << key;
  sets.receive(made::delta_tile(4));  // nothing makes room for it
  EXPECT_FALSE(sets.store().contains(4));
}

TEST(LeafSetsMemory, FarthestShellsGoFirstAndTheSetIsCompleteWithoutThem) {
  LeafSets sets(made::frame(), 2 * made::kTileBytes);
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2, 3, 4}));
  for (const ContentHash key : {4, 3, 2, 1}) sets.receive(made::tile(key));  // in the worst order
  sets.update(true);
  EXPECT_TRUE(sets.view()->is_complete);
  EXPECT_EQ(serials(*sets.view()),
            (std::vector<std::uint64_t>{sets.store().tile(1)->serial, sets.store().tile(2)->serial}));
}

TEST(LeafSetsMemory, GivenUpPayloadsAreReportedWhenNoPinnedSetNeedsThem) {
  LeafSets sets(made::frame(), 2 * made::kTileBytes);
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2, 3}));
  for (const ContentHash key : {1, 2, 3}) sets.receive(made::tile(key));
  sets.update(true);
  EXPECT_THAT(sets.take_evicted(), IsEmpty());
  sets.set_eye(made::eye_in(1));
  sets.announce(made::leaf_set(2, 1, {11}));
  sets.receive(made::tile(11));
  sets.update(true);
  ASSERT_EQ(sets.view()->leaf, made::leaf_at(1));
  EXPECT_THAT(sets.take_evicted(), ::testing::Contains(3));
}

TEST(LeafSetsMemory, EnteringAnAnnouncedLeafAsksAgainForWhatTheOldSetGaveUp) {
  LeafSets sets(made::frame(), 2 * made::kTileBytes);
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2, 3}));
  for (const ContentHash key : {1, 2, 3}) sets.receive(made::tile(key));
  sets.update(true);
  sets.announce(made::leaf_set(2, 1, {3}, /*is_current=*/false));
  EXPECT_THAT(sets.take_evicted(), IsEmpty());
  sets.set_eye(made::eye_in(1));  // no new manifest will come
  sets.update(true);
  EXPECT_THAT(sets.take_evicted(), ::testing::ElementsAre(3));
  sets.receive(made::tile(3));
  sets.update(true);
  EXPECT_EQ(sets.view()->leaf, made::leaf_at(1));
  EXPECT_EQ(sets.view()->tiles.size(), 1u);
}

TEST(LeafSetsMemory, AnItemLargerThanTheWholeStoreIsDoneWithout) {
  LeafSets sets(made::frame(), 2 * made::kTileBytes);
  sets.set_eye(made::eye_in(0));
  sets.announce(made::leaf_set(1, 0, {1, 2}));
  sets.receive(made::tile(1));
  sets.receive(made::tile(2, 5 * made::kTileBytes));
  sets.update(true);
  EXPECT_TRUE(sets.view()->is_complete);
  EXPECT_EQ(sets.view()->tiles.size(), 1u);
}

// Whatever the cap (at least one item) and whatever is asked for: the cap holds at every step, each announced set
// is shown once all it consists of has been sent, and the picture is never blank.
TEST(LeafSetsMemory, AnyCapMakesProgress) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](unsigned n) { return std::uniform_int_distribution<unsigned>(0, n - 1)(random); };
    const std::size_t largest = 200 + 4 * 16 * 16 + sizeof(TextureLevel);
    LeafSets sets(made::frame(), largest + below(12) * 700);
    bool has_shown = false;
    for (std::uint64_t step = 1; step <= 25; ++step) {
      const int leaf = static_cast<int>(below(6)) * (below(4) == 0 ? 20 : 1);
      LeafSet set = made::leaf_set(step, leaf, {});
      for (unsigned i = 0; i < 1 + below(8); ++i) set.tiles.push_back(100 + below(30));
      for (unsigned i = 0; i < below(4); ++i) set.chunks.push_back({200 + below(8), below(2) ? 300 + below(4) : 0});
      if (below(5) == 0) set.is_fallback = true;
      sets.set_eye(made::eye_in(leaf));
      sets.announce(set);
      sets.update(true);
      const auto deliver = [&](DecodedPayload payload) {
        if (sets.is_redundant(payload.name)) return;
        if (below(20) == 0) {
          sets.abandon(payload.name);
        } else {
          sets.receive(std::move(payload));
        }
        ASSERT_LE(sets.store().size_bytes(), sets.store().budget_bytes());
        sets.update(below(2) == 0);
        has_shown |= sets.view() && (!sets.view()->tiles.empty() || !sets.view()->chunks.empty());
        if (has_shown) {
          ASSERT_FALSE(sets.view()->tiles.empty() && sets.view()->chunks.empty());
        }
      };
      for (const LeafSetChunk& chunk : set.chunks) {
        deliver(made::chunk(chunk.chunk, 300));
        if (chunk.texture) deliver(made::texture_level(chunk.texture, 1, 8));
      }
      for (const ContentHash tile : set.tiles) deliver(made::tile(tile, 100 + tile));
      for (const LeafSetChunk& chunk : set.chunks) {
        if (chunk.texture) deliver(made::texture_level(chunk.texture, 0, 16));
      }
      sets.update(true);
      if (set.is_fallback || !has_shown) continue;
      ASSERT_NE(sets.shown(), nullptr);
      EXPECT_EQ(sets.shown()->set().leaf, set.leaf) << "seed " << seed << " step " << step;
      EXPECT_TRUE(sets.shown()->is_complete());
    }
  }
}

}  // namespace
}  // namespace farfield::client

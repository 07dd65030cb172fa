// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/leaf_planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "server/impostor/view_catalogue.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::Blocks;
using test::PlacedScene;

// A closed room in an open place with blocks around it, near and far.
PlacedScene room_in_town() {
  Blocks blocks;
  blocks.quad({-400, -2, 400}, {800, 0, 0}, {0, 0, -800}, {90, 90, 90, 255}, 8);
  blocks.box({{-3.2, -1.7, -3.2}, {-0.4, 1.7, -0.4}})
      .room({{-3, -1.5, -3}, {-0.6, 1.5, -0.6}}, {180, 190, 170, 255}, 2);
  for (int z = -3; z <= 3; ++z)
    for (int x = -3; x <= 3; ++x)
      if (x != 0 || z != 0) blocks.box(test::cube({40.0 * x, 3, 40.0 * z}, 5));
  return blocks.build();
}

class LeafPlannerTest : public testing::Test {
 protected:
  LeafPlannerTest() : placed(room_in_town()) {
    settings.finest_side_m = 8;    // one leaf holds the room and some of what is around it …
    settings.near_triangles = 60;  // … and few of the blocks are near
    const NestedShells shells{grid(), settings.kappa};
    const auto tree = std::make_shared<CellTree>(placed.scene, shells, settings.near_triangles);
    leaves = std::make_shared<LeafPlanner>(
        placed.scene, tree, std::make_shared<ViewCatalogue>(placed.scene, tree, shells, settings), shells, settings);
  }
  SharedPlan plan_of(const glm::dvec3& world) {
    const CellId leaf = leaves->leaf_at(placed.at(world), nullptr).value();
    return leaves->plan(leaf, nullptr).value();
  }
  CellGrid grid() const { return {settings.finest_side_m}; }

  PlacedScene placed;
  ImpostorSettings settings;
  std::shared_ptr<LeafSource> leaves;
};

TEST_F(LeafPlannerTest, InAClosedRoomTheOuterShellsCostNothing) {
  const glm::dvec3 in_room(-1.8, 0.2, -1.8), outside(-1.8, 2.5, -1.8);
  const SharedPlan whole = plan_of(in_room);
  ASSERT_TRUE(grid().box(whole->leaf).contains(placed.at(outside))) << "or this test shows nothing";
  EXPECT_GT(whole->tiles.size(), 20u);
  ASSERT_EQ(whole->enclosures.size(), 2u);
  const SharedPlan inside = plan_at(whole, grid(), placed.at(in_room)),
                   street = plan_at(whole, grid(), placed.at(outside));
  ASSERT_NE(inside, whole);
  ASSERT_NE(street, whole);
  EXPECT_FALSE(inside->is_same_as(*street));
  EXPECT_TRUE(inside->tiles.empty());
  EXPECT_FALSE(inside->background_visible);
  EXPECT_FALSE(inside->chunks.empty());
  EXPECT_GT(street->tiles.size(), 20u);
  EXPECT_TRUE(street->background_visible);
  EXPECT_TRUE(inside->speaks_for(grid(), placed.at(in_room)));
  EXPECT_FALSE(inside->speaks_for(grid(), placed.at(outside)));
  EXPECT_TRUE(whole->speaks_for(grid(), placed.at(in_room)));
}

TEST_F(LeafPlannerTest, TheWholeListsWhatItsEnclosuresList) {
  const SharedPlan whole = plan_of({-1.8, 0.2, -1.8});
  std::set<TileId> tiles;
  for (const NeededTile& tile : whole->tiles) tiles.insert(tile.id);
  const std::set<std::uint32_t> chunks(whole->chunks.begin(), whole->chunks.end());
  for (const SharedPlan& part : whole->enclosures) {
    EXPECT_EQ(part->leaf, whole->leaf);
    EXPECT_EQ(part->root, whole->root);
    for (const NeededTile& tile : part->tiles) EXPECT_TRUE(tiles.contains(tile.id));
    for (const std::uint32_t chunk : part->chunks) EXPECT_TRUE(chunks.contains(chunk));
  }
}

TEST_F(LeafPlannerTest, WhereNoWallIsOnePlanServesTheLeaf) {
  const SharedPlan whole = plan_of({100, 30, 20});
  EXPECT_TRUE(whole->enclosures.empty());
  EXPECT_TRUE(whole->enclosure.is_whole());
  EXPECT_EQ(plan_at(whole, grid(), placed.at({100, 30, 20})), whole);
}

// A closed room of 4 m in a hall, with a block outside its wall: nobody in the room sees either.
struct RoomInAHall {
  explicit RoomInAHall(const ImpostorSettings& wanted) : settings(wanted) {
    Blocks blocks;
    blocks.room({{-60, -60, -60}, {60, 60, 60}}, {90, 90, 90, 255}, 2).box({{-2.2, -2.2, -2.2}, {2.2, 2.2, 2.2}}, {200, 120, 90, 255}, 8);
    blocks.box({{3.2, -0.5, -0.5}, {4.2, 0.5, 0.5}}, {200, 120, 90, 255}, 8);
    blocks.room({{-2, -2, -2}, {2, 2, 2}}, {180, 190, 170, 255}, 8);
    placed = blocks.build();
    const NestedShells shells{CellGrid{settings.finest_side_m}, settings.kappa};
    tree = std::make_shared<CellTree>(placed.scene, shells, settings.near_triangles);
    catalogue = std::make_shared<ViewCatalogue>(placed.scene, tree, shells, settings);
    leaves = std::make_shared<LeafPlanner>(placed.scene, tree, catalogue, shells, settings);
  }
  // Of a finest cell, whatever the budget: one that holds part of the room and nothing else.
  SharedPlan plan_of(const glm::dvec3& world) const { return leaves->plan(CellGrid{settings.finest_side_m}.cell_at(placed.at(world), 0), nullptr).value(); }

  ImpostorSettings settings;
  PlacedScene placed;
  std::shared_ptr<CellTree> tree;
  std::shared_ptr<ViewCatalogue> catalogue;
  std::shared_ptr<LeafPlanner> leaves;
};

ImpostorSettings settings_of_a_room(std::uint32_t near_triangles) {
  ImpostorSettings settings;
  settings.finest_side_m = 2;
  settings.near_triangles = near_triangles;
  return settings;
}

TEST(LeafSkips, InAClosedRoomEveryTileOfEveryShellIsCountedAsUnseen) {
  const RoomInAHall room(settings_of_a_room(20000));
  const SharedPlan plan = room.plan_of({0.4, 0.4, 0.4});
  ASSERT_TRUE(plan->tiles.empty());
  const auto shells = static_cast<std::uint64_t>(plan->root.level - plan->leaf.level + 1);
  const auto tiles = static_cast<std::uint64_t>(room.settings.face_tiles);
  EXPECT_EQ(plan->skips.tiles_unseen, shells * kCubeFaces * tiles * tiles);
  EXPECT_EQ(plan->skips.tiles_too_small, 0u);
  EXPECT_EQ(plan->delta_views, -1) << "nothing is seen: no views are chosen";
  EXPECT_EQ(room.catalogue->delta_views_unneeded(), 0u);
}

class NearChunks : public testing::TestWithParam<std::uint32_t> {};

TEST_P(NearChunks, AreListedOrCountedByWhyTheyAreNot) {
  const RoomInAHall room(settings_of_a_room(GetParam()));
  const SharedPlan plan = room.plan_of({0.4, 0.4, 0.4});
  const NestedShells shells{CellGrid{room.settings.finest_side_m}, room.settings.kappa};
  const std::vector<std::uint32_t> near = room.placed.scene->chunks_in(shells.near_region(plan->leaf));
  std::uint64_t triangles = 0;
  for (const std::uint32_t chunk : near) triangles += room.placed.scene->chunks()[chunk].triangles;
  EXPECT_GE(plan->skips.triangles_unseen, 384u) << "of the block";
  EXPECT_EQ(plan->chunks.size() + plan->skips.chunks_unseen + plan->skips.chunks_facing_away, near.size());
  EXPECT_EQ(plan->near_triangles + plan->skips.triangles_unseen, triangles);
  EXPECT_EQ(room.leaves->skips().triangles_unseen, plan->skips.triangles_unseen);
  room.leaves->plan(plan->leaf, nullptr).value();
  EXPECT_EQ(room.leaves->skips().triangles_unseen, 2 * plan->skips.triangles_unseen) << "planned and skipped again";
}

// The room, its outside and the block are 2304 triangles: what nobody sees is left out whether or not all would fit the budget.
INSTANTIATE_TEST_SUITE_P(AboveAndBelowTheBudget, NearChunks, testing::Values(1400u, 5000u));

TEST_F(LeafPlannerTest, WhatIsListedAndWhatIsSkippedAreAllTilesOfTheShells) {
  const SharedPlan plan = plan_of({100, 30, 20});
  const auto faces = [](int edge) { return static_cast<std::uint64_t>(kCubeFaces) * edge * edge; };
  const std::uint64_t intra = faces(settings.face_tiles), delta = faces(face_regions(settings.edge_samples(1)));
  const std::uint64_t all = plan->tiles.size() + plan->skips.tiles_unseen + plan->skips.tiles_too_small;
  const auto levels = static_cast<std::uint64_t>(plan->root.level - plan->leaf.level + 1);
  ASSERT_GE(all, levels * intra);
  EXPECT_EQ((all - levels * intra) % delta, 0u) << "beside the intra views, whole delta views";
  EXPECT_GT(plan->skips.tiles_too_small, 0u) << "distant blocks' rims";
  EXPECT_GE(plan->delta_views, 0);
}

TEST(LeafSkips, ALeafWithinSolidMatterIsBlockedAndGetsOneView) {
  Blocks blocks;
  blocks.room({{-60, -60, -60}, {60, 60, 60}}, {90, 90, 90, 255}, 2).box({{-8, -8, -8}, {8, 8, 8}}, {200, 120, 90, 255}, 8);
  const PlacedScene placed = blocks.build();
  const ImpostorSettings settings = settings_of_a_room(300);
  const NestedShells shells{CellGrid{settings.finest_side_m}, settings.kappa};
  const auto tree = std::make_shared<CellTree>(placed.scene, shells, settings.near_triangles);
  LeafPlanner leaves(placed.scene, tree, std::make_shared<ViewCatalogue>(placed.scene, tree, shells, settings), shells, settings);
  const auto plan_of = [&](const glm::dvec3& world) { return leaves.plan(leaves.leaf_at(placed.at(world), nullptr).value(), nullptr).value(); };
  const SharedPlan inside = plan_of({0.3, 0.3, 0.3}), outside = plan_of({0.3, 20, 0.3});
  EXPECT_EQ(inside->skips.blocked_cells, 1u);
  EXPECT_LE(inside->delta_views, 0);
  EXPECT_EQ(outside->skips.blocked_cells, 0u);
  EXPECT_EQ(leaves.skips().blocked_cells, 1u);
  EXPECT_FALSE(leaves.can_stand_in(inside->leaf, nullptr).value());
  EXPECT_TRUE(leaves.can_stand_in(outside->leaf, nullptr).value());
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/leaf_planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

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

}  // namespace
}  // namespace farfield

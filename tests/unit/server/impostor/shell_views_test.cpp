// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/shell_views.h"

#include <gtest/gtest.h>

#include "common/cells/sampling.h"
#include "server/impostor/view_catalogue.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::PlacedScene;

const ImpostorSettings kSettings;

TEST(ShellViews, AConvexRoomNeedsNoDeltaView) {
  const PlacedScene placed = test::plain_room().build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const ShellViews views = choose_views(*placed.scene, space, kSettings, ViewSearchWidth::kLeaf, nullptr);
  ASSERT_EQ(views.positions.size(), 1u);
  EXPECT_LT(glm::distance(views.positions[0], space.box.center()), 1e-9);
  EXPECT_LE(views.void_worst_sr, kSettings.void_target * 4 * M_PI);
}

TEST(ShellViews, APillarNeedsDeltaViewsAndTheyFindWhatItHides) {
  const PlacedScene placed = test::pillar_room().build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const ShellViews views = choose_views(*placed.scene, space, kSettings, ViewSearchWidth::kLeaf, nullptr);
  ASSERT_GE(views.positions.size(), 2u);
  EXPECT_LE(views.positions.size(), 1u + kSettings.delta_views);
  EXPECT_GT(views.first_void_sr, 0.01);
  EXPECT_LT(views.void_worst_sr, 0.1 * views.first_void_sr);
  EXPECT_LE(views.void_mean_sr, views.void_worst_sr);
  ASSERT_EQ(views.warp_gains.size(), views.positions.size());
  for (std::size_t k = 0; k < views.positions.size(); ++k) {
    const glm::dvec3 offset = (views.positions[k] - space.box.center()) / space.side_m;
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(offset[axis]), 0.5);
    EXPECT_NEAR(views.warp_gains[k], warp_gain(offset, kSettings.kappa), 1e-12);
  }
}

// The first view sees all of the floor, from a hand's breadth below it.
TEST(ShellViews, AFloorThatTheFirstViewOnlyGrazesNeedsAnotherFarFromIt) {
  constexpr double kFloor = 0.0625;
  const PlacedScene placed = test::Blocks().quad({2.75, kFloor, -4}, {0, 0, 8}, {8, 0, 0}, {150, 150, 150, 255}, 4).build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const ShellViews views = choose_views(*placed.scene, space, kSettings, ViewSearchWidth::kLeaf, nullptr);
  ASSERT_GE(views.positions.size(), 2u);
  EXPECT_GT(std::abs(views.positions[1].y - placed.at(glm::dvec3(0, kFloor, 0)).y), 0.3);
}

TEST(ShellViews, EveryFurtherViewLeavesLessVoid) {
  const PlacedScene placed = test::pillar_room().build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  ImpostorSettings settings;
  double before = 1e9;
  for (int count = 0; count <= 2; ++count) {
    settings.delta_views = count;
    const ShellViews views = choose_views(*placed.scene, space, settings, ViewSearchWidth::kLeaf, nullptr);
    EXPECT_LE(views.positions.size(), 1u + count);
    EXPECT_LE(views.void_worst_sr, before);
    before = views.void_worst_sr;
  }
}

TEST(ShellViews, AreTheSameEveryTime) {
  const PlacedScene placed = test::pillar_room().build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const ShellViews a = choose_views(*placed.scene, space, kSettings, ViewSearchWidth::kLeaf, nullptr), b = choose_views(*placed.scene, space, kSettings, ViewSearchWidth::kLeaf, nullptr);
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (std::size_t k = 0; k < a.positions.size(); ++k) EXPECT_TRUE(glm::all(glm::equal(a.positions[k], b.positions[k])));
}

TEST(ShellViews, ACellWithinSolidMatterHasOneView) {
  test::Blocks blocks = test::pillar_room();
  blocks.box({{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}});
  const PlacedScene placed = blocks.build();
  EXPECT_EQ(choose_views(*placed.scene, test::space_around(placed, {0, 0, 0}, 1.0), kSettings, ViewSearchWidth::kLeaf, nullptr).positions.size(), 1u);
}

TEST(ShellViews, WhatVoidsDoNotAskForIsCountedAsUnneeded) {
  const ImpostorSettings settings = kSettings;
  const NestedShells shells{CellGrid{1.0}, settings.kappa};
  const auto unneeded_in = [&](const PlacedScene& placed, std::size_t& chosen) {
    const auto tree = std::make_shared<CellTree>(placed.scene, shells, 1000000);
    ViewCatalogue catalogue(placed.scene, tree, shells, settings);
    const CellId cell = shells.grid.cell_at(placed.at(glm::dvec3(0)), 0);
    chosen = catalogue.views(cell, nullptr).value()->positions.size() - 1;
    catalogue.views(cell, nullptr).value();  // known already: not counted again
    return catalogue.delta_views_unneeded();
  };
  std::size_t chosen = 0;
  const auto allowed = static_cast<std::uint64_t>(settings.delta_views);
  EXPECT_EQ(unneeded_in(test::plain_room().build(), chosen), allowed) << "a convex room needs none";
  EXPECT_EQ(chosen, 0u);
  const std::uint64_t unneeded = unneeded_in(test::pillar_room().build(), chosen);
  EXPECT_GT(chosen, 0u);
  EXPECT_GT(unneeded, 0u);
  EXPECT_EQ(unneeded + chosen, allowed);
}

TEST(ShellViews, TheIntraViewStandsAtAFreePointNearTheCentre) {
  test::Blocks blocks = test::plain_room();
  blocks.box({{-0.25, -0.25, -0.25}, {0.25, 0.25, 0.25}});
  const PlacedScene placed = blocks.build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const ShellViews views = choose_views(*placed.scene, space, kSettings, ViewSearchWidth::kLeaf, nullptr);
  const glm::dvec3 offset = glm::abs(views.positions[0] - space.box.center());
  EXPECT_GT(std::max({offset.x, offset.y, offset.z}), 0.25) << "not inside the block";
}

TEST(ShellViews, StopAsSoonAsTheyAreCancelled) {
  const PlacedScene placed = test::pillar_room().build();
  const std::atomic<bool> cancelled = true;
  EXPECT_EQ(choose_views(*placed.scene, test::space_around(placed, {0, 0, 0}, 1.0), kSettings, ViewSearchWidth::kLeaf, &cancelled).positions.size(), 1u);
}

TEST(ShellViews, SnappedPositionsAreExactFloatsRelativeToTheCell) {
  const CellSpace space{CellId{}, {{1e5, -3e4, 8}, {1e5 + 4, -3e4 + 4, 12}}, 4.0, {}};
  const glm::dvec3 snapped = snap_to_cell(space, {1e5 + 1.23456789, -3e4 + 3.3, 11.999});
  EXPECT_LE(glm::distance(snapped, glm::dvec3(1e5 + 1.23456789, -3e4 + 3.3, 11.999)), 4.0 / 1024);
  const glm::dvec3 offset = (snapped - space.box.center()) / space.side_m;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(offset[axis], static_cast<double>(static_cast<float>(offset[axis])), 1e-15);
}

}  // namespace
}  // namespace farfield

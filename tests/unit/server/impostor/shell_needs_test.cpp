// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/shell_needs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::PlacedScene;

// Whether somebody in a cell around the origin needs a delta view's tiles of a floor at `height_m` outside its near region. The
// intra view stands at the origin, the delta view 0.45 m above it.
bool needs_delta_view(double height_m) {
  const PlacedScene placed = test::Blocks().quad({2.75, static_cast<float>(height_m), -4}, {0, 0, 8}, {8, 0, 0}, {150, 150, 150, 255}, 4).build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const BoxVisibility sight = probe_visibility(*placed.scene, space.box, space.shell.inside, {.edge = 40});
  const auto views = std::make_shared<ShellViews>();
  views->positions = {placed.at(glm::dvec3(0)), placed.at(glm::dvec3(0, 0.45, 0))};
  const ImpostorSettings settings;
  ShellNeeds needs(*placed.scene, space, views, settings, sight);
  for (const FarHit& hit : sight.far_hits) needs.add(hit);
  needs.ask_delta_views();
  std::vector<NeededTile> tiles;
  needs.list(ShellNeeds::kWhole, tiles);
  EXPECT_TRUE(std::any_of(tiles.begin(), tiles.end(), [](const NeededTile& tile) { return !tile.id.is_delta(); }));
  return std::any_of(tiles.begin(), tiles.end(), [](const NeededTile& tile) { return tile.id.is_delta(); });
}

// Its tile keeps the samples that the intra view stretches (DeltaTile): they would be made for nobody.
TEST(ShellNeeds, TheTileOfADeltaViewIsListedWhereTheIntraViewOnlyGrazes) { EXPECT_TRUE(needs_delta_view(0.0625)); }

TEST(ShellNeeds, WhatTheIntraViewShowsWellIsNeededOfNoOther) { EXPECT_FALSE(needs_delta_view(-1)); }

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/far_view.h"

#include <gtest/gtest.h>

#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

TEST(FarView, SamplesLieOnTheRoomAndNotBeforeTheNearRegion) {
  const test::PillarRoom room;
  const FarView view = cast_far_view(room.scene(), room.space, room.centre() + glm::dvec3(0.3, -0.2, 0.1), 66);
  const Box walls = room.placed.at(Box{{-4, -4, -4}, {4, 4, 4}});
  for (const FarFace& face : view.faces)
    for (int j = 0; j < face.edge(); ++j)
      for (int i = 0; i < face.edge(); ++i) {
        ASSERT_TRUE(face.covered[face.at(i, j)]);
        const glm::dvec3 point = face.point(i, j);
        EXPECT_TRUE(walls.grown(1e-4).contains(point));
        EXPECT_FALSE(room.space.shell.inside.grown(-1e-4).contains(point));
      }
}

TEST(FarView, APointIsFoundWhereItsSampleIs) {
  const test::PillarRoom room;
  const FarFace face = cast_far_face(room.scene(), room.space, room.centre(), 3, 66);
  for (int k = 0; k < 66; k += 5) {
    const auto place = place_on(face.frame, face.point(k, 65 - k));
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->i, k, 1e-4);
    EXPECT_NEAR(place->j, 65 - k, 1e-4);
    EXPECT_NEAR(place->disparity, face.disparity[face.at(k, 65 - k)], 1e-6);
  }
  EXPECT_FALSE(place_on(face.frame, room.centre() + glm::dvec3(0, 3, 0)));  // face 3 looks down
  EXPECT_FALSE(place_on(face.frame, room.centre() + glm::dvec3(3, -1, 0)));
}

TEST(FarView, BeginsALittleWithinTheNearRegionAndNeverEnds) {
  const NestedShells shells{CellGrid{0.5}, 2.0};
  const CellId leaf = shells.grid.cell_at({0.3, 0.4, 0.5}, 1);
  const CellSpace space = far_space(shells, leaf);
  EXPECT_TRUE(shells.near_region(leaf).contains(space.shell.inside));
  EXPECT_NEAR(space.shell.inside.min.x - shells.near_region(leaf).min.x, kOverlapSides * 1.0, 1e-12);
  EXPECT_TRUE(space.contains({1e9, 0, 0}));
}

}  // namespace
}  // namespace farfield::bench

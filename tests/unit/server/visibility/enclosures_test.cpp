// SPDX-License-Identifier: Apache-2.0
#include "server/visibility/enclosures.h"

#include <gtest/gtest.h>

#include "server/visibility/standpoints.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::Blocks;
using test::PlacedScene;

const Box kHall{{-8, -8, -8}, {8, 8, 8}};
constexpr double kVoxel = 0.25;

// A hall with a wall across it, in which a door of this width and half as high as the hall may stand open.
PlacedScene divided_hall(float door) {
  Blocks blocks;
  blocks.room(kHall);
  blocks.box({{0.1, -8, -8}, {0.3, 8, -door / 2}}).box({{0.1, -8, door / 2}, {0.3, 8, 8}});
  if (door > 0) blocks.box({{0.1, 0, -door / 2}, {0.3, 8, door / 2}});
  return blocks.build();
}

Enclosures enclosures_of(const PlacedScene& placed, const Box& world) {
  const Box box = placed.at(world);
  return find_enclosures(*placed.scene, box, find_standpoints(*placed.scene, box).points, kVoxel);
}

int mask_at(const Enclosures& found, const PlacedScene& placed, const Box& world, const glm::dvec3& point) {
  for (std::size_t k = 0; k < found.masks.size(); ++k)
    if (found.masks[k].contains(placed.at(world), placed.at(point))) return static_cast<int>(k);
  return -1;
}

TEST(JoinBySight, ThoseWhoSeeEachOtherOrAThirdAreTogether) {
  // Two see each other around the end of a screen only by way of the third.
  const PlacedScene placed = Blocks()
                                 .box({{-0.1, -4, -4}, {0.1, 4, 4}})
                                 .room({{19, -1, -1}, {21, 1, 1}})
                                 .box({{18, -2, -2}, {22, 2, 2}})
                                 .build();
  const std::vector<glm::dvec3> viewpoints{placed.at({-2, 0, 0}), placed.at({20, 0, 0}), placed.at({2, 0, 0}),
                                           placed.at({0, 9, 0})};
  EXPECT_EQ(join_by_sight(*placed.scene, viewpoints), (std::vector<int>{0, 1, 0, 0}));
  EXPECT_EQ(join_by_sight(*placed.scene, {viewpoints[0], viewpoints[2]}), (std::vector<int>{0, 1}));
}

TEST(Enclosures, AClosedWallDividesABox) {
  const PlacedScene placed = divided_hall(0);
  const Box box = test::cube({0, 0, 0}, 8);
  const Enclosures found = enclosures_of(placed, box);
  ASSERT_EQ(found.masks.size(), 2u);
  const int left = mask_at(found, placed, box, {-3, 1, 1}), right = mask_at(found, placed, box, {3, 1, 1});
  EXPECT_GE(left, 0);
  EXPECT_GE(right, 0);
  EXPECT_NE(left, right);
  // As near to the wall as the voxels are fine, and never across it.
  for (double y = -3.9; y < 4; y += 0.37)
    for (double z = -3.9; z < 4; z += 0.41) {
      EXPECT_EQ(mask_at(found, placed, box, {0.1 - 2 * kVoxel, y, z}), left);
      EXPECT_EQ(mask_at(found, placed, box, {0.3 + 2 * kVoxel, y, z}), right);
      EXPECT_NE(mask_at(found, placed, box, {0.05, y, z}), right);
      EXPECT_NE(mask_at(found, placed, box, {0.35, y, z}), left);
    }
  for (std::size_t v = 0; v < found.viewpoints.size(); ++v)
    EXPECT_EQ(found.of_viewpoint[v], found.viewpoints[v].x + placed.scene->origin().x < 0.2 ? left : right);
}

TEST(Enclosures, AnOpenDoorJoinsWhatTheWallDivides) {
  const PlacedScene placed = divided_hall(1);
  EXPECT_TRUE(enclosures_of(placed, test::cube({0, 0, 0}, 8)).masks.empty());
}

TEST(Enclosures, AnOpenBoxIsWhole) {
  const PlacedScene placed = divided_hall(0);
  const Box box = test::cube({-4.5, 0, 0}, 2);
  const Enclosures found = enclosures_of(placed, box);
  EXPECT_TRUE(found.masks.empty());
  EXPECT_EQ(found.viewpoints.size(), 27u) << "nothing is added where nothing is hidden";
}

TEST(Enclosures, ARoomBetweenTheViewpointsIsFound) {
  const Box walls{{-3.2, -1.7, -3.2}, {-0.4, 1.7, -0.4}}, room{{-3, -1.5, -3}, {-0.6, 1.5, -0.6}};
  const PlacedScene placed = Blocks().room({{-30, -30, -30}, {30, 30, 30}}).box(walls).room(room).build();
  const Box box = test::cube({0, 0, 0}, 8);
  for (const glm::dvec3& point : find_standpoints(*placed.scene, placed.at(box)).points)
    ASSERT_FALSE(placed.at(room).contains(point));
  const Enclosures found = enclosures_of(placed, box);
  ASSERT_EQ(found.masks.size(), 2u);
  const int inside = mask_at(found, placed, box, {-1.8, 0.2, -1.8}), outside = mask_at(found, placed, box, {3, 2, 2});
  EXPECT_GE(inside, 0);
  EXPECT_GE(outside, 0);
  EXPECT_NE(inside, outside);
  std::size_t in_room = 0;
  for (std::size_t v = 0; v < found.viewpoints.size(); ++v)
    if (found.of_viewpoint[v] == inside) {
      ++in_room;
      EXPECT_TRUE(placed.at(room).contains(found.viewpoints[v]));
    }
  EXPECT_GE(in_room, 4u);
}

TEST(Enclosures, AreTheSameEveryTime) {
  const PlacedScene placed = divided_hall(0);
  const Enclosures a = enclosures_of(placed, test::cube({0, 0, 0}, 8)),
                   b = enclosures_of(placed, test::cube({0, 0, 0}, 8));
  EXPECT_EQ(a.masks, b.masks);
  EXPECT_EQ(a.of_viewpoint, b.of_viewpoint);
  EXPECT_EQ(a.viewpoints, b.viewpoints);
}

}  // namespace
}  // namespace farfield

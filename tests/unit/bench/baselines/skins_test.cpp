// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/skins.h"

#include <gtest/gtest.h>

#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

using A = Adjacency;

bool is_on_pillar(const test::PillarRoom& room, const glm::dvec3& point) {
  return room.placed.at(test::kPillar).grown(1e-4).contains(point);
}

TEST(Skins, ConnectWallsAndCutThePillarOff) {
  const test::PillarRoom room;
  const FarFace face = cast_far_face(room.scene(), room.space, room.centre(), 0, 130);
  SkinLimits coarse;  // for samples that see the jump under 2 degrees
  coarse.least_angle_rad *= 2;
  const Adjacency joined = connect_surfaces(face, {}, coarse);
  int walls = 0, wall_skins = 0, borders = 0, border_skins = 0;
  for (int j = 0; j + 1 < face.edge(); ++j)  // rows run along the pillar
    for (int i = 0; i < face.edge(); ++i) {
      const bool a = is_on_pillar(room, face.point(i, j)), b = is_on_pillar(room, face.point(i, j + 1));
      const bool is_joined = joined.is_connected(i, j, A::kDown);
      if (a != b) ++borders, border_skins += !is_joined;
      else ++walls, wall_skins += !is_joined;
    }
  EXPECT_EQ(wall_skins, 0) << "of " << walls;
  EXPECT_EQ(borders, 2 * face.edge());
  EXPECT_EQ(border_skins, borders);
}

TEST(Skins, AnotherViewThatSeesPastAConnectionCutsIt) {
  const test::PillarRoom room;
  const FarView aside = cast_far_view(room.scene(), room.space, room.centre() + glm::dvec3(0, 0, 0.45), 130);
  const FarView centre = cast_far_view(room.scene(), room.space, room.centre(), 130);
  // Halfway between the pillar's rim and the wall behind it.
  const glm::dvec3 rim = room.placed.at(glm::dvec3(2.75, 0, 0.5)), behind = room.placed.at(glm::dvec3(4, 0, 0.72));
  EXPECT_TRUE(sees_past(aside, 0.5 * (rim + behind)));
  EXPECT_FALSE(sees_past(aside, room.placed.at(glm::dvec3(2.75, 0, 0))));   // on the pillar
  EXPECT_FALSE(sees_past(aside, room.placed.at(glm::dvec3(3.5, 0, -0.3))));  // behind it
  // With an angle that finds nothing, test 3 alone must.
  SkinLimits blind;
  blind.least_angle_rad = 0;
  const FarView* views[] = {&aside};
  const auto skins = [&](std::span<const FarView* const> others) {
    const Adjacency joined = connect_surfaces(centre.faces[0], others, blind);
    int count = 0;
    for (int j = 0; j < 130; ++j)
      for (int i = 0; i + 1 < 130; ++i) count += !joined.is_connected(i, j, A::kRight) || !joined.is_connected(i, j, A::kDown);
    return count;
  };
  EXPECT_EQ(skins({}), 129) << "the last row alone has no lower neighbours";
  EXPECT_GT(skins(views), 129 + 60);
}

}  // namespace
}  // namespace farfield::bench

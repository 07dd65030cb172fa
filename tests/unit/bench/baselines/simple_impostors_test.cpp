// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/simple_impostors.h"

#include <gtest/gtest.h>

#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

class SimpleImpostorsTest : public testing::Test {
 protected:
  test::PillarRoom room;
  FarView view = cast_far_view(room.scene(), room.space, room.centre(), 258);
  test::FarComparison comparison{room};
};

TEST_F(SimpleImpostorsTest, ABillboardIsExactAtTheCellsCentreOnly) {
  const auto panels = make_billboard(view, room.space);
  comparison.show(panels);
  const test::Difference centre = comparison.at(room.centre());
  EXPECT_LT(centre.mean, 1);
  EXPECT_LT(centre.wrong_share, 0.03);
  EXPECT_LT(comparison.drawn.triangles, 12u) << "the face behind is not drawn";
  EXPECT_NEAR(comparison.uncovered_share(), 0, 1e-9);
  EXPECT_GT(comparison.at(room.centre() + glm::dvec3(0, 0, 0.45)).mean, 3 * centre.mean);
}

TEST_F(SimpleImpostorsTest, TheBillboardsCubeStandsAtTheMedianButOutsideTheNearRegion) {
  EXPECT_LE(billboard_disparity(view, room.space), 1 / 2.5);
  EXPECT_NEAR(billboard_disparity(view, room.space), 0.25, 1e-3) << "most of the room's samples are on its walls";
  CellSpace wide = room.space;
  wide.shell.inside = room.space.box.grown(5);
  EXPECT_NEAR(billboard_disparity(view, wide), 1 / (5.5 + kOverlapSides), 1e-9);
}

TEST_F(SimpleImpostorsTest, ADepthMeshReproducesItsOwnViewAndWarpsSurfaces) {
  const auto panels = make_depth_sheet(view, room.space, 0.5, test::kFarDisplay, 2);
  comparison.show(panels);
  const test::Difference centre = comparison.at(room.centre());
  EXPECT_LT(centre.mean, 1);
  EXPECT_LT(centre.wrong_share, 0.03);
  EXPECT_NEAR(comparison.uncovered_share(), 0, 1e-9) << "skins leave no hole";
  // Better than the flat picture anywhere, though not right behind the pillar.
  const glm::dvec3 aside = room.centre() + glm::dvec3(0, 0, 0.45);
  const double sheet = comparison.at(aside).mean;
  EXPECT_NEAR(comparison.uncovered_share(), 0, 1e-9);
  const auto flat = make_billboard(view, room.space);
  comparison.show(flat);
  EXPECT_LT(sheet, comparison.at(aside).mean);
}

}  // namespace
}  // namespace farfield::bench

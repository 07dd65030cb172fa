// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/void_probe.h"

#include <gtest/gtest.h>

#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

constexpr double kSlack = 1e-3;

VoidCount count(const test::PlacedScene& placed, const std::vector<glm::dvec3>& world_views, int round = 0) {
  std::vector<glm::dvec3> views;
  for (const glm::dvec3& view : world_views) views.push_back(placed.at(view));
  return count_voids(*placed.scene, test::space_around(placed, glm::dvec3(0), 1), views, kSlack, round, nullptr);
}

TEST(VoidProbe, WhereEverythingCanBeSeenNothingIsVoid) {
  const VoidCount plain = count(test::plain_room().build(), {glm::dvec3(0)});
  EXPECT_GT(plain.rays, 30000u);
  EXPECT_EQ(plain.hits, 0u);
}

TEST(VoidProbe, CountsTheWallBehindAPillarAndLessOfItWithMoreViews) {
  const test::PlacedScene placed = test::pillar_room().build();
  const VoidCount one = count(placed, {glm::dvec3(0)});
  EXPECT_GT(one.hits, 30u);
  EXPECT_GT(one.worst_hits, one.hits / 12) << "the worst viewpoint sees more than the mean one";
  const glm::dvec3 worst = placed.at(glm::dvec3(0)) - one.worst;
  EXPECT_GT(std::abs(worst.z), 0.2) << "it stands to the side, from where one looks past the pillar";
  const VoidCount three = count(placed, {glm::dvec3(0), {0, 0, -0.48}, {0, 0, 0.48}});
  EXPECT_LT(three.hits, one.hits / 4);
  ASSERT_EQ(three.left.size(), 3u) << "the counts had the views ended earlier";
  EXPECT_EQ(three.left[0].hits, one.hits);
  EXPECT_EQ(three.left[0].worst_hits, one.worst_hits);
  EXPECT_EQ(three.left[2].hits, three.hits);
  EXPECT_EQ(three.left[2].worst_hits, three.worst_hits);
}

TEST(VoidProbe, RoundsAreIndependentAndEachIsReproducible) {
  const test::PlacedScene placed = test::pillar_room().build();
  const VoidCount first = count(placed, {glm::dvec3(0)}), again = count(placed, {glm::dvec3(0)}), other = count(placed, {glm::dvec3(0)}, 1);
  EXPECT_EQ(first.hits, again.hits);
  EXPECT_EQ(first.worst, again.worst);
  EXPECT_NE(first.worst, other.worst);
  // Two estimates of one share: within five standard deviations, those of viewpoints among them.
  EXPECT_NEAR(first.hits, other.hits, 0.5 * first.hits);
}

TEST(VoidProbe, CancelledWorkCountsNothing) {
  const test::PlacedScene placed = test::plain_room().build();
  const std::atomic<bool> cancel{true};
  EXPECT_EQ(count_voids(*placed.scene, test::space_around(placed, glm::dvec3(0), 1), {placed.at(glm::dvec3(0))}, kSlack, 0, &cancel).rays, 0u);
}

}  // namespace
}  // namespace farfield

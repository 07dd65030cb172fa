// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/view_search.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

const Box kSquare{{0, 1, 0}, {2, 1, 2}};

std::vector<glm::dvec3> corners() { return {{0, 1, 0}, {2, 1, 0}, {0, 1, 2}, {2, 1, 2}}; }

TEST(ViewSearch, FourCornersGiveTheCentreAndTheMiddlesOfTheSides) {
  const std::vector<glm::dvec3> found = planar_candidates(corners(), kSquare);
  EXPECT_EQ(found.size(), 5u);
  for (const glm::dvec3& wanted : {glm::dvec3(1, 1, 1), {1, 1, 0}, {1, 1, 2}, {0, 1, 1}, {2, 1, 1}})
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const glm::dvec3& p) { return glm::distance(p, wanted) < 1e-9; }));
}

TEST(ViewSearch, CandidatesAreEquidistantFromTheirNearestSites) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> inside(0, 2);
  for (int round = 0; round < 20; ++round) {
    std::vector<glm::dvec3> sites = corners();
    for (int k = 0; k < round % 7; ++k) sites.emplace_back(inside(random), 1, inside(random));
    for (const glm::dvec3& p : planar_candidates(sites, kSquare)) {
      std::vector<double> distances;
      for (const glm::dvec3& site : sites) distances.push_back(glm::distance(p, site));
      std::sort(distances.begin(), distances.end());
      const bool is_on_border = std::min({p.x, p.z, 2 - p.x, 2 - p.z}) < 1e-9;
      EXPECT_NEAR(distances[1], distances[0], 1e-6);
      if (!is_on_border) {
        EXPECT_NEAR(distances[2], distances[0], 1e-6) << "a vertex of the diagram has three";
      }
      EXPECT_NEAR(p.y, 1, 1e-9);
    }
  }
}

TEST(ViewSearch, EyeHeightIsKeptWithinTheCell) {
  EXPECT_DOUBLE_EQ(eye_rectangle({{0, 0, 0}, {1, 1, 1}}, 0.7).min.y, 0.7);
  EXPECT_DOUBLE_EQ(eye_rectangle({{0, 0, 0}, {1, 1, 1}}, 3).max.y, 1);
}

TEST(ViewSearch, TakesViewsUntilTheVoidIsSmallEnoughOrNoMoreAreAllowed) {
  const test::PillarRoom room;
  const auto cast = [&](const glm::dvec3& p) { return cast_far_view(room.scene(), room.space, p, 66); };
  const Box rectangle = eye_rectangle(room.space.box, room.centre().y);
  ViewSearch search;
  search.void_edge = 32;
  search.void_sr = 0.005, search.most_views = 9;
  const FoundViews many = find_views(rectangle, 1.0, search, cast);
  EXPECT_EQ(many.positions.size(), many.worst_void_sr.size() + 3) << "one figure for four views, five, …";
  EXPECT_TRUE(many.worst_void_sr.back() <= 0.005 || many.positions.size() == 9u);
  EXPECT_LE(many.worst_void_sr.back(), many.worst_void_sr.front());
  for (const glm::dvec3& p : many.positions) EXPECT_TRUE(room.space.box.grown(1e-9).contains(p));
  search.void_sr = 12;
  EXPECT_EQ(find_views(rectangle, 1.0, search, cast).positions.size(), 4u);
}

}  // namespace
}  // namespace farfield::bench

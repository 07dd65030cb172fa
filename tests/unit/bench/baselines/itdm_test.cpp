// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/itdm.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/bench/baselines/simple_impostors.h"
#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

TEST(DependencyTree, IsRootedNearTheCentroidAndJoinsNeighbours) {
  const std::vector<glm::dvec3> positions{{0, 0, 0}, {2, 0, 0}, {0, 0, 2}, {2, 0, 2}, {1, 0, 1}, {2, 0, 1}};
  const std::vector<std::size_t> parents = dependency_tree(positions).parents;
  EXPECT_EQ(parents[4], 4u);
  EXPECT_EQ(parents[5], 4u);
  EXPECT_EQ(parents[0], 4u);
  EXPECT_EQ(parents[1], 5u);  // nearer than the centre
  EXPECT_EQ(parents[3], 5u);
}

TEST(RedundantSamples, AreThoseAnAncestorShows) {
  const test::PillarRoom room;
  const FarView centre = cast_far_view(room.scene(), room.space, room.centre(), 130);
  const FarView aside = cast_far_view(room.scene(), room.space, room.centre() + glm::dvec3(0, 0, 0.45), 130);
  const FarView* ancestors[] = {&centre};
  const FarFace& face = aside.faces[0];
  const double tolerance = SkinLimits::one_sample(face.frame);
  const std::vector<std::uint8_t> redundant = redundant_samples(face, ancestors, tolerance);
  int hidden = 0, hidden_kept = 0, seen = 0, seen_dropped = 0;
  for (int j = 20; j < 110; ++j)
    for (int i = 0; i < face.edge(); ++i) {
      const glm::dvec3 p = face.point(i, j) - room.placed.at(glm::dvec3(0));
      if (p.x < 3.99 || std::abs(p.y) > 3) continue;  // on the wall behind the pillar
      const double z_rim = p.z * 2.75 / p.x;  // where the centre's ray to it passes the pillar's front
      if (std::abs(std::abs(z_rim) - 0.5) < 0.03) continue;
      (std::abs(z_rim) < 0.5 ? hidden : seen)++;
      (std::abs(z_rim) < 0.5 ? hidden_kept : seen_dropped) += redundant[face.at(i, j)] == (std::abs(z_rim) < 0.5 ? 0 : 1);
    }
  EXPECT_GT(hidden, 100);
  EXPECT_EQ(hidden_kept, hidden);
  EXPECT_EQ(seen_dropped, seen);
  const FarView* itself[] = {&aside};
  const std::vector<std::uint8_t> all = redundant_samples(face, itself, tolerance);
  EXPECT_EQ(std::count(all.begin(), all.end(), 0), 0);
}

TEST(Itdm, ShowsWhatOneMeshCannotAndDropsMostOfItsSamples) {
  const test::PillarRoom room;
  ItdmOptions options;
  options.face_samples = 258, options.display = test::kFarDisplay;
  options.search.void_sr = 0.02, options.search.void_edge = 48;
  const ItdmCell cell = make_itdm(room.scene(), room.space, room.centre().y, options);
  EXPECT_GE(cell.found.positions.size(), 4u);
  EXPECT_GT(static_cast<double>(cell.redundant), 0.8 * static_cast<double>(cell.samples));
  const FarView view = cast_far_view(room.scene(), room.space, room.centre(), 258);
  const auto sheet = make_depth_sheet(view, room.space, 0.5, test::kFarDisplay, 2);
  test::FarComparison meshes(room), sheets(room);
  meshes.show(cell.panels);
  sheets.show(sheet);
  std::mt19937 random(7);
  double itdm = 0, tdm = 0, uncovered = 0;
  for (int k = 0; k < 6; ++k) {
    glm::dvec3 eye = room.random_eye(random);
    eye.y = room.centre().y;
    itdm += meshes.at(eye).wrong_share / 6, uncovered += meshes.uncovered_share() / 6, tdm += sheets.at(eye).wrong_share / 6;
  }
  EXPECT_LT(itdm, tdm);
  EXPECT_LT(uncovered, 0.005);
}

TEST(Itdm, EachFurtherScanUncoversLess) {
  const test::PillarRoom room;
  ItdmOptions options;
  options.face_samples = 258, options.display = test::kFarDisplay;
  options.search.void_sr = 0.02, options.search.void_edge = 48;
  const ItdmCell cell = make_itdm(room.scene(), room.space, room.centre().y, options);
  ASSERT_EQ(cell.panels.size(), cell.tree.positions.size() * kCubeFaces);
  test::FarComparison meshes(room);
  const glm::dvec3 eye = room.centre() + glm::dvec3(0, 0, 0.45);
  const auto uncovered_with = [&](const ScanBudget& budget) {
    meshes.show(cell.panels, cell.tree, budget);
    meshes.at(eye);
    return meshes.uncovered_share();
  };
  const double one = uncovered_with({1, 0}), two = uncovered_with({2, 0}), all = uncovered_with({});
  EXPECT_GT(one, 0.01);  // what the intra cube alone cannot show beside the pillar
  EXPECT_LT(two, 0.5 * one);
  EXPECT_LE(all, two);
  const std::size_t triangles = (uncovered_with({1, 0}), meshes.drawn.triangles);
  EXPECT_NEAR(uncovered_with({0, triangles}), one, 1e-12);
  EXPECT_EQ(meshes.drawn.triangles, triangles);
  EXPECT_LT(uncovered_with({0, 100 * triangles}), 0.5 * one);
}

}  // namespace
}  // namespace farfield::bench

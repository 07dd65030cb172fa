// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/border_pairs.h"

#include <gtest/gtest.h>

#include "tests/unit/server/scene/scene_models.h"

namespace farfield::bench {
namespace {

using Place = BorderPair::Place;

std::vector<CellId> walk(const std::vector<int>& columns) {
  std::vector<CellId> leaves;
  for (const int x : columns) leaves.push_back({.level = 0, .x = x});
  return leaves;
}

TEST(BorderPairs, CrossingsAndOthersArePickedEvenlyInOrder) {
  std::vector<int> columns;
  for (int step = 0; step < 100; ++step) columns.push_back(step / 10);
  const std::vector<BorderPair> pairs = pick_border_pairs(walk(columns), 3);
  ASSERT_EQ(pairs.size(), 9u);
  std::vector<std::size_t> crossings;
  std::size_t last_place = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (pairs[k].place == Place::kAfterCrossing) {
      ASSERT_TRUE(k > 0 && pairs[k - 1].place == Place::kCrossing);
      EXPECT_EQ(pairs[k].step, pairs[k - 1].step + kStepsAfterCrossing);
      continue;
    }
    EXPECT_EQ(pairs[k].place == Place::kCrossing, columns[pairs[k].step] != columns[pairs[k].step + 1]);
    EXPECT_TRUE(k == 0 || last_place < pairs[k].step);
    last_place = pairs[k].step;
    if (pairs[k].place == Place::kCrossing) crossings.push_back(pairs[k].step);
  }
  EXPECT_EQ(crossings, (std::vector<std::size_t>{19, 49, 79}));  // of nine: the second, fifth and eighth
}

TEST(BorderPairs, ThereMayBeFewerThanAskedFor) {
  EXPECT_TRUE(pick_border_pairs({}, 5).empty());
  EXPECT_TRUE(pick_border_pairs(walk({0}), 5).empty());
  const std::vector<BorderPair> pairs = pick_border_pairs(walk({0, 1, 1}), 5);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].place, Place::kCrossing);  // and the walk ends before the pair after it
  EXPECT_EQ(pairs[1].place, Place::kInside);
  EXPECT_TRUE(pick_border_pairs(walk({0, 1, 1}), 0).empty());
}

// A sphere a third of a metre before the eye, and the lower half of a wall far behind it.
struct NearAndFar {
  std::shared_ptr<const Scene> scene;
  ImpostorSettings settings;
  Display display{.width = 64, .height = 48, .fovy_rad = 2.0};
  Pose eye{{0, 0, 1.3}, {1, 0, 0, 0}};

  NearAndFar() {
    Mesh mesh = test::sphere(24);
    mesh.normals.clear();
    test::add_triangle(mesh, {-400, -300, -60}, {400, -300, -60}, {0, 10, -60});
    scene = test::build(test::model_of(mesh));
    eye.position -= scene->origin();
    settings.near_triangles = 500;
  }
};

TEST(ViewerCells, FarIsWhatLiesOutsideTheNearRegionOfTheLeaf) {
  const NearAndFar world;
  const ViewerCells cells(world.scene, world.settings);
  const ReferenceImage truth = render_reference(*world.scene, world.eye, world.display, 16);
  const std::vector<std::uint8_t> is_far = cells.far_pixels(world.eye, world.display, truth);
  const std::size_t middle = 24 * 64 + 32, below = 46 * 64 + 4, above = 4;
  ASSERT_TRUE(truth.has_surface[middle] && truth.has_surface[below] && !truth.has_surface[above]);
  EXPECT_FALSE(is_far[middle]);
  EXPECT_TRUE(is_far[below]);
  EXPECT_FALSE(is_far[above]);  // no surface, so no impostor
}

TEST(BorderPairs, TruthItselfChangesNothingAndAWrongFrameShows) {
  const NearAndFar world;
  const ViewerCells cells(world.scene, world.settings);
  Trace trace;
  for (int k = 0; k <= 12; ++k) {
    Pose pose = world.eye;
    pose.position += world.scene->origin() + glm::dvec3(0.15 * k, 0, 0.02 * k);
    trace.frames.push_back({k / 60.0, pose});
  }
  const auto pairs = BorderPairs::create(*world.scene, cells, trace, 2, world.display, 1);
  ASSERT_TRUE(pairs);
  ASSERT_EQ(pairs->poses().size(), 10u);  // the walk is too short for what comes after the second crossing
  ASSERT_EQ(pairs->trace().frames.size(), 10u);
  EXPECT_LT(glm::distance(pairs->trace().frames[3].pose.position, pairs->poses()[3].position + world.scene->origin()), 1e-9);
  const auto truth_of = [&](std::size_t k) -> Result<std::vector<std::uint8_t>> {
    return render_reference(*world.scene, pairs->poses()[k], world.display, 1).rgb;
  };
  const auto exact = pairs->judge(world.display, truth_of);
  ASSERT_TRUE(exact);
  EXPECT_DOUBLE_EQ(exact->inside_p99, 0);
  EXPECT_DOUBLE_EQ(exact->crossing_p99, 0);
  const auto wrong = pairs->judge(world.display, [&](std::size_t k) {
    return k == 1 ? Result<std::vector<std::uint8_t>>(std::vector<std::uint8_t>(3 * 64 * 48)) : truth_of(k);
  });
  ASSERT_TRUE(wrong);
  EXPECT_GT(std::max(wrong->inside_p99, wrong->crossing_p99), 0.1);
}

TEST(BorderPairs, WhatComesAfterACrossingIsWalkedInItsOwnTime) {
  const NearAndFar world;
  const ViewerCells cells(world.scene, world.settings);
  Trace trace;
  for (int k = 0; k <= 60; ++k) {
    Pose pose = world.eye;
    pose.position += world.scene->origin() + glm::dvec3(0.03 * k, 0, 0.004 * k);
    trace.frames.push_back({k / 60.0, pose});
  }
  const auto pairs = BorderPairs::create(*world.scene, cells, trace, 1, world.display, 1);
  ASSERT_TRUE(pairs);
  ASSERT_EQ(pairs->poses().size(), 6u);
  // One place inside, one crossing with the pair after it, in either order.
  const std::vector<TraceFrame> walked = pairs->trace().frames;
  std::size_t after = 0;
  for (std::size_t k = 1; k < walked.size(); ++k) {
    const double wait_s = walked[k].time_s - walked[k - 1].time_s;
    if (std::abs(wait_s - (kStepsAfterCrossing - 1) / 60.0) < 1e-9) after = k;
  }
  ASSERT_TRUE(after == 2 || after == 4);
  const auto black_from = [&](std::size_t first) {
    return pairs->judge(world.display, [&, first](std::size_t k) -> Result<std::vector<std::uint8_t>> {
      if (k >= first && k < after + 2) return std::vector<std::uint8_t>(3 * 64 * 48);
      return render_reference(*world.scene, pairs->poses()[k], world.display, 1).rgb;
    });
  };
  const auto at_border = black_from(after - 1), later = black_from(after + 1);
  ASSERT_TRUE(at_border && later);
  EXPECT_GT(at_border->crossing_p99, 0.1);
  EXPECT_DOUBLE_EQ(later->crossing_p99, 0);
  EXPECT_GT(later->after_crossing_p99, 0.1);
}

}  // namespace
}  // namespace farfield::bench

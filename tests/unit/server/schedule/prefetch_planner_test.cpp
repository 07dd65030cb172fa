// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/prefetch_planner.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace farfield {
namespace {

constexpr double kRate_hz = 30;

struct PrefetchPlannerTest : testing::Test {
  CellGrid grid{1.0};
  PrefetchPlanner planner{grid};
  std::vector<PrefetchTarget> targets;
  double now_s = 0;
  glm::dvec3 position{0.3, 1.7, 0.3};
  int heading_changes = 0;

  void pose() {
    targets = planner.update({.position = position}, now_s);
    heading_changes += planner.heading_changed() ? 1 : 0;
  }
  void walk(const glm::dvec3& velocity, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * kRate_hz); ++i) {
      now_s += 1 / kRate_hz;
      position += velocity / kRate_hz;
      pose();
    }
  }
};

TEST_F(PrefetchPlannerTest, ListsTheCellsAheadSoonestFirst) {
  pose();
  walk({1.5, 0, 0}, 2);
  ASSERT_FALSE(targets.empty());
  std::set<CellId> listed;
  double last_s = 0;
  for (const PrefetchTarget& target : targets) {
    EXPECT_GT(target.seconds_until_needed, last_s);
    last_s = target.seconds_until_needed;
    EXPECT_NEAR(target.viewpoint.x, position.x + 1.5 * target.seconds_until_needed, 0.01);
    EXPECT_NE(grid.cell_at(target.viewpoint, 0), grid.cell_at(position, 0));
    EXPECT_TRUE(listed.insert(grid.cell_at(target.viewpoint, 0)).second);
  }
  // Six metres ahead: every finest cell on the way.
  for (double ahead_m = 1.5 * 0.25; ahead_m < 5.0; ahead_m += 0.25) {
    const CellId cell = grid.cell_at(position + glm::dvec3(ahead_m, 0, 0), 0);
    EXPECT_TRUE(cell == grid.cell_at(position, 0) || listed.contains(cell)) << ahead_m;
  }
  EXPECT_LE(last_s, 4.0);
  EXPECT_EQ(heading_changes, 0);
}

TEST_F(PrefetchPlannerTest, AStandingViewerPrefetchesNothing) {
  pose();
  walk({0, 0, 0}, 3);
  EXPECT_TRUE(targets.empty());
  walk({1.5, 0, 0}, 1);
  EXPECT_FALSE(targets.empty());
  walk({0, 0, 0}, 1);
  EXPECT_TRUE(targets.empty());
  EXPECT_GE(heading_changes, 1) << "stopping makes the targets ahead stale";
}

TEST_F(PrefetchPlannerTest, AFirstPoseSaysNothingAboutTheWay) {
  pose();
  EXPECT_TRUE(targets.empty());
}

TEST_F(PrefetchPlannerTest, ATurnIsReportedAndTheNewPathListed) {
  pose();
  walk({1.5, 0, 0}, 2);
  walk({0, 0, 1.5}, 1);
  EXPECT_GE(heading_changes, 1);
  ASSERT_FALSE(targets.empty());
  EXPECT_GT(targets.back().viewpoint.z, position.z + 3);
  const int before = heading_changes;
  walk({0, 0, 1.5}, 2);
  EXPECT_EQ(heading_changes, before) << "walking straight on changes nothing";
}

TEST_F(PrefetchPlannerTest, ASlowCurveIsReportedOnceItAddsUp) {
  pose();
  walk({1.5, 0, 0}, 1);
  double angle = 0;
  for (int i = 0; i < 60; ++i) {
    angle += 0.02;
    walk({1.5 * std::cos(angle), 0, 1.5 * std::sin(angle)}, 1.01 / kRate_hz);
  }
  EXPECT_GE(heading_changes, 1);
  EXPECT_LE(heading_changes, 4);
}

TEST_F(PrefetchPlannerTest, AJumpDropsThePathAndStartsOver) {
  pose();
  walk({1.5, 0, 0}, 2);
  position += glm::dvec3(300, 0, 0);
  now_s += 1 / kRate_hz;
  pose();
  EXPECT_TRUE(targets.empty());
  EXPECT_TRUE(planner.heading_changed());
}

TEST_F(PrefetchPlannerTest, StopsAtTheByteBudgetAndGoesOnBelowIt) {
  pose();
  walk({1.5, 0, 0}, 1);
  planner.add_outstanding(std::size_t{8} << 20);
  EXPECT_FALSE(planner.may_prefetch());
  walk({1.5, 0, 0}, 0.2);
  EXPECT_TRUE(targets.empty());
  planner.remove_outstanding(1);
  walk({1.5, 0, 0}, 0.2);
  EXPECT_FALSE(targets.empty());
  planner.remove_outstanding(~std::size_t{0});  // more than there is: zero, no wrap-around
  EXPECT_EQ(planner.outstanding_bytes(), 0u);
}

TEST_F(PrefetchPlannerTest, AFastFlightIsBoundedInTargets) {
  pose();
  walk({60, 0, 0}, 2);
  EXPECT_FALSE(targets.empty());
  EXPECT_LE(targets.size(), 32u);
  EXPECT_GT(targets.back().seconds_until_needed, 1.5) << "sampled more coarsely, not less far";
}

TEST_F(PrefetchPlannerTest, UntrustedPosesDoNoHarm) {
  pose();
  walk({1.5, 0, 0}, 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(planner.update({.position = {nan, 0, 0}}, now_s + 0.1).empty());
  EXPECT_TRUE(planner.update({.position = position}, now_s - 1).empty());
  for (double huge : {1e12, 1e300, -1e300}) {
    now_s += 0.01;
    planner.update({.position = {huge, huge, huge}}, now_s);
  }
  now_s += 0.01;
  pose();
  walk({1.5, 0, 0}, 1);
  EXPECT_FALSE(targets.empty());
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace farfield::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const CostAxis& kTime = kCostAxes[0];
const CostAxis& kBytes = kCostAxes[1];

// Points as (frame ms, FLIP).
Curve curve(const std::string& name, const std::vector<std::pair<double, double>>& points) {
  Curve result{name, "quality", {}};
  for (const auto& [ms, flip] : points) result.points.push_back({static_cast<double>(result.points.size()), ms, kNone, flip, 40});
  return result;
}

TEST(Knee, IsWhereTheCurveBends) {
  EXPECT_EQ(knee_of(curve("a", {{1, 1}, {2, 0.1}, {10, 0.08}, {100, 0.05}}).points, kTime), 1u);
}

TEST(Knee, DoesNotDependOnOrderOrUnits) {
  EXPECT_EQ(knee_of(curve("a", {{100, 0.05}, {2, 0.1}, {1, 1}, {10, 0.08}}).points, kTime), 1u);
  EXPECT_EQ(knee_of(curve("a", {{1e3, 1}, {2e3, 0.1}, {1e4, 0.08}, {1e5, 0.05}}).points, kTime), 1u);
}

TEST(Knee, StraightAndBulgingCurvesHaveNone) {
  EXPECT_FALSE(knee_of(curve("bulging", {{1, 1}, {10, 0.9}, {100, 0.01}}).points, kTime));
  EXPECT_FALSE(knee_of(curve("two points", {{1, 1}, {10, 0.1}}).points, kTime));
  EXPECT_FALSE(knee_of(curve("dearer and worse", {{1, 0.1}, {10, 0.2}, {100, 0.3}}).points, kTime));
  EXPECT_FALSE(knee_of({}, kTime));
}

TEST(Knee, LeavesOutWhatHasNoLogarithm) {
  EXPECT_EQ(knee_of(curve("a", {{1, 1}, {2, 0.1}, {10, 0.08}, {100, 0.05}, {200, 0}}).points, kTime), 1u);
  EXPECT_FALSE(knee_of(curve("streams nothing", {{1, 1}, {2, 0.1}, {100, 0.05}}).points, kBytes));
}

TEST(LeastCost, IsInterpolatedBetweenNeighbours) {
  const Curve curves[] = {curve("a", {{1, 0.1}, {100, 0.001}})};
  EXPECT_NEAR(least_cost_for(curves, kTime, 0.01), 10, 1e-9);
  EXPECT_DOUBLE_EQ(least_cost_for(curves, kTime, 0.5), 1);
  EXPECT_DOUBLE_EQ(least_cost_for(curves, kTime, 0.001), 100);
  EXPECT_TRUE(std::isnan(least_cost_for(curves, kTime, 0.0005)));
}

TEST(LeastCost, TakesTheCheapestOfAllCurves) {
  const Curve curves[] = {curve("a", {{10, 0.1}, {20, 0.01}}), curve("b", {{5, 0.2}, {9, 0.05}, {30, 0.02}})};
  EXPECT_LT(least_cost_for(curves, kTime, 0.1), 9);
  EXPECT_NEAR(least_cost_for(curves, kTime, 0.01), 20, 1e-12);
}

TEST(Dominance, HoldsBelowAndLeft) {
  const Curve mine[] = {curve("farfield", {{1, 0.1}, {10, 0.01}})};
  EXPECT_THAT(dominance_report("farfield", mine, curve("tdm", {{2, 0.1}, {20, 0.01}}), kTime),
              ElementsAre("frame time: farfield lies below and left of tdm:quality"));
}

TEST(Dominance, NamesThePointsWhereItDoesNotHoldAndWhy) {
  const Curve mine[] = {curve("farfield", {{1, 0.1}, {10, 0.01}})};
  const auto lines = dominance_report("farfield", mine, curve("rays", {{2, 0.02}, {20, 0.02}, {30, 0.005}}), kTime);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_THAT(lines[0], HasSubstr("rays at quality 0 (2 ms, FLIP 0.0200): for that error it needs 5 ms"));
  EXPECT_THAT(lines[1], HasSubstr("rays at quality 2 (30 ms, FLIP 0.0050): no value of its knobs has so small an error"));
}

TEST(Dominance, SaysNothingWhereThereIsNothingToCompare) {
  const Curve mine[] = {curve("farfield", {{1, 0.1}})};
  EXPECT_THAT(dominance_report("farfield", mine, curve("rays", {{2, 0.2}}), kBytes), IsEmpty());
  EXPECT_THAT(dominance_report("farfield", {}, curve("rays", {{2, 0.2}}), kTime), IsEmpty());
}

}  // namespace
}  // namespace farfield::bench

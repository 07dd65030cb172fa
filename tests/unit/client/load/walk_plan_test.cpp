// SPDX-License-Identifier: Apache-2.0
#include "client/load/walk_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "common/trace/trace_file.h"
#include "tests/support/temporary_folder.h"

namespace farfield::client {
namespace {

const Box kWide{{-1000, -10, -1000}, {1000, 10, 1000}};

Trace straight(double x, double seconds = 10, double speed = 2) {
  Trace trace;
  for (int k = 0; k <= 10; ++k) trace.frames.push_back({k * seconds / 10, {{x, 1.7, -speed * seconds * k / 10}, glm::dquat(1, 0, 0, 0)}});
  return trace;
}

class WalkPlanTest : public testing::Test {
 protected:
  WalkPlan load(WalkOptions options) { return WalkPlan::load(options).value(); }
  std::filesystem::path write(const char* name, const Trace& trace) {
    const std::filesystem::path file = folder_.path() / name;
    EXPECT_TRUE(write_trace(file, trace));
    return file;
  }
  TemporaryFolder folder_;
};

TEST(ParseWalk, KnowsItsForms) {
  EXPECT_EQ(parse_walk("random")->kind, WalkOptions::Kind::kRandom);
  EXPECT_EQ(parse_walk("trace:a/b.trace")->traces, "a/b.trace");
  EXPECT_EQ(parse_walk("herd")->kind, WalkOptions::Kind::kHerd);
  EXPECT_EQ(parse_walk("herd:x")->traces, "x");
  for (const char* text : {"", "walk", "trace", "trace:", "herd:", "random:x", "traces:x"}) EXPECT_FALSE(parse_walk(text)) << text;
}

TEST(RandomWalk, KeepsItsSpeedItsHeightAndItsBounds) {
  const Box narrow{{0, 0, 0}, {20, 3, 30}};
  const Trace trace = random_walk(narrow, {10, 1.7, 10}, 1.4, 300, 60, 5);
  for (std::size_t k = 1; k < trace.frames.size(); ++k) {
    const glm::dvec3 &a = trace.frames[k - 1].pose.position, &b = trace.frames[k].pose.position;
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(b, narrow.min)) && glm::all(glm::lessThanEqual(b, narrow.max)));
    EXPECT_NEAR(b.y, 1.7, 1e-12);
    EXPECT_LE(glm::distance(a, b), 0.14 + 1e-9);
  }
  EXPECT_GT(length_of(trace), 0.7 * 1.4 * 300) << "who walks along a wall is slower for a while";
  const Trace far = random_walk(kWide, {0, 1.7, 0}, 1.4, 300, 60, 5);
  EXPECT_NEAR(length_of(far), 1.4 * 300, 20);
}

TEST_F(WalkPlanTest, RandomWalksAreOnesOwnAndRepeatable) {
  const WalkPlan plan = load({});
  const glm::dvec3 start(0, 1.7, 0);
  EXPECT_NEAR(glm::distance(plan.path_of(0, kWide, start).at(30).position, plan.path_of(0, kWide, start).at(30).position), 0, 1e-12);
  EXPECT_GT(glm::distance(plan.path_of(0, kWide, start).at(30).position, plan.path_of(1, kWide, start).at(30).position), 0.1);
}

TEST_F(WalkPlanTest, RecordedPathsAreWalkedToTheirEndAndBackFacingTheWay) {
  const WalkPlan plan = load({.kind = WalkOptions::Kind::kTraces, .traces = write("a.trace", straight(3))});
  const WalkPath path = plan.path_of(0, kWide, {});
  EXPECT_NEAR(path.at(4).position.z, -8, 1e-6);
  EXPECT_NEAR(path.at(14).position.z, -12, 1e-6) << "on the way back";
  EXPECT_NEAR(path.at(24).position.z, -8, 1e-6) << "and again";
  const glm::dvec3 ahead = path.at(4).world_from_camera * glm::dvec3(0, 0, -1), back = path.at(14).world_from_camera * glm::dvec3(0, 0, -1);
  EXPECT_NEAR(glm::dot(ahead, back), -1, 1e-6);
}

TEST_F(WalkPlanTest, SpeedIsThatAskedFor) {
  const WalkPlan plan = load({.kind = WalkOptions::Kind::kTraces, .traces = write("a.trace", straight(3)), .speed_m_s = 0.5});
  const WalkPath path = plan.path_of(0, kWide, {});
  EXPECT_NEAR(glm::distance(path.at(2).position, path.at(6).position), 2, 1e-6);
}

TEST_F(WalkPlanTest, ViewersShareTheTracesOfAFolderAndEnterThemAtDifferentPlaces) {
  write("b.trace", straight(2)), write("a.trace", straight(1)), write("note.txt", straight(9));
  const WalkPlan plan = load({.kind = WalkOptions::Kind::kTraces, .traces = folder_.path()});
  EXPECT_NEAR(plan.path_of(0, kWide, {}).at(0).position.x, 1, 1e-9);
  EXPECT_NEAR(plan.path_of(1, kWide, {}).at(0).position.x, 2, 1e-9);
  EXPECT_NEAR(plan.path_of(2, kWide, {}).at(0).position.x, 1, 1e-9);
  EXPECT_GT(glm::distance(plan.path_of(0, kWide, {}).at(0).position, plan.path_of(2, kWide, {}).at(0).position), 1);
}

TEST_F(WalkPlanTest, AHerdGoesOneBehindTheOther) {
  const WalkPlan plan = load({.kind = WalkOptions::Kind::kHerd, .traces = write("a.trace", straight(3))});
  const WalkPath first = plan.path_of(0, kWide, {}), second = plan.path_of(1, kWide, {});
  EXPECT_NEAR(glm::distance(first.at(5).position, second.at(5.5).position), 0, 1e-6);
  const WalkPlan random = load({.kind = WalkOptions::Kind::kHerd});
  EXPECT_NEAR(glm::distance(random.path_of(0, kWide, {}).at(5).position, random.path_of(7, kWide, {}).at(5).position), 0, 1e-9) << "the same way";
}

TEST_F(WalkPlanTest, SaysWhatIsMissing) {
  EXPECT_FALSE(WalkPlan::load({.kind = WalkOptions::Kind::kTraces, .traces = folder_.path() / "none.trace"}));
  const auto empty = WalkPlan::load({.kind = WalkOptions::Kind::kTraces, .traces = folder_.path()});
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace farfield::client

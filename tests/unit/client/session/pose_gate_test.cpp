// SPDX-License-Identifier: Apache-2.0
#include "client/session/pose_gate.h"

#include <gtest/gtest.h>

#include "client/session/backoff.h"
#include "client/session/wire_convert.h"

namespace farfield::client {
namespace {

class PoseGateTest : public ::testing::Test {
 protected:
  Pose at(double x) const { return {{x, 0.25, 0.25}, {1, 0, 0, 0}}; }
  bool offer(const Pose& pose, double time_s, PoseGate::Lacks lacks = {}) {
    const bool sends = gate.decide(pose, lacks, time_s).should_send;
    if (sends) gate.note_sent(pose, lacks, time_s);
    return sends;
  }
  PoseGate gate{CellGrid{0.5}, 2.0, Display{}, 60};
};

TEST_F(PoseGateTest, AMovingViewerSendsSixtyASecond) {
  int sent = 0;
  for (int i = 0; i < 1000; ++i) sent += offer(at(0.001 * i), 0.001 * i);
  EXPECT_GE(sent, 57);
  EXPECT_LE(sent, 61);
}

TEST_F(PoseGateTest, OneMorePoseEndsAMovementThenSilence) {
  EXPECT_TRUE(offer(at(0.1), 0.0));
  EXPECT_TRUE(offer(at(0.2), 0.05));
  EXPECT_FALSE(offer(at(0.2), 0.10));
  EXPECT_NEAR(*gate.decide(at(0.2), {}, 0.10).ask_again_in_s, 0.05, 1e-9);
  EXPECT_TRUE(offer(at(0.2), 0.16));
  for (double t = 0.2; t < 100; t += 0.5) EXPECT_FALSE(offer(at(0.2), t));
  EXPECT_FALSE(gate.decide(at(0.2), {}, 200).ask_again_in_s.has_value());
}

TEST_F(PoseGateTest, TinyMovesAddUpAndBordersAlwaysCount) {
  offer(at(0.499999), 0);
  offer(at(0.499999), 1);
  EXPECT_FALSE(offer(at(0.4999995), 2));
  EXPECT_TRUE(offer(at(0.5), 3)) << "another cell, however small the move";
  offer(at(0.5), 4);
  int sent = 0;
  for (int i = 0; i < 100; ++i) sent += offer(at(0.5 + 1e-5 * i), 5 + i);
  EXPECT_GT(sent, 3);
  EXPECT_LT(sent, 30);
}

TEST_F(PoseGateTest, ALeafSetThatHasComeIsToldOnce) {
  EXPECT_TRUE(offer(at(0.1), 0, {.leaf_set = true}));
  EXPECT_TRUE(offer(at(0.1), 1, {.leaf_set = true})) << "the end of a movement";
  EXPECT_FALSE(offer(at(0.1), 2, {.leaf_set = true}));
  EXPECT_TRUE(offer(at(0.1), 3));
  EXPECT_TRUE(offer(at(0.1), 4)) << "the end of a movement";
  for (double t = 5; t < 100; t += 0.5) EXPECT_FALSE(offer(at(0.1), t));
}

TEST_F(PoseGateTest, TurningCounts) {
  offer(at(0.1), 0);
  offer(at(0.1), 1);
  Pose turned = at(0.1);
  turned.world_from_camera = glm::angleAxis(1e-4, glm::dvec3(0, 1, 0));
  EXPECT_FALSE(offer(turned, 2));
  turned.world_from_camera = -glm::angleAxis(0.01, glm::dvec3(0, 1, 0));  // the same rotation, other sign
  EXPECT_TRUE(offer(turned, 3));
}

TEST_F(PoseGateTest, WantingTheFallbackIsSentWhileStandingStill) {
  offer(at(0.1), 0);
  offer(at(0.1), 1);
  EXPECT_TRUE(offer(at(0.1), 2, {.usable_view = true}));
}

TEST(Backoff, DoublesWithJitterUpToFiveSecondsAndStartsAnew) {
  Backoff backoff(7);
  std::chrono::milliseconds last{0};
  for (int i = 0; i < 20; ++i) {
    last = backoff.next();
    EXPECT_GE(last, Backoff::kShortest);
    EXPECT_LE(last, Backoff::kLongest);
  }
  EXPECT_GE(last, Backoff::kLongest / 2);
  EXPECT_GE(backoff.next(std::chrono::milliseconds(8000)), std::chrono::milliseconds(8000));
  backoff.reset();
  EXPECT_LE(backoff.next(), std::chrono::milliseconds(200));
}

TEST(WirePosition, BothSidesPutTheEyeIntoOneLeaf) {
  const CellGrid grid{0.5};
  for (const double x : {0.0, 0.5, std::nextafter(0.5, 0.0), 0.499999999, 123.4567890123, -77.77777777}) {
    const glm::dvec3 once = position_on_wire(grid, {x, 0.1, 0.2});
    EXPECT_NEAR(once.x, x, 3e-8);
    EXPECT_EQ(position_on_wire(grid, once), once) << x;
  }
}

}  // namespace
}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/input/walk_camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace farfield::client {
namespace {

constexpr double kHalfPi = 1.5707963267948966;

glm::dvec3 looking(const WalkCamera& camera) {
  return camera.pose().world_from_camera * glm::dvec3(0, 0, -1);
}

TEST(WalkCamera, StartsWhereItIsPut) {
  const glm::dquat start = glm::angleAxis(0.8, glm::dvec3(0, 1, 0)) * glm::angleAxis(-0.4, glm::dvec3(1, 0, 0));
  const WalkCamera camera({{1, 2, 3}, start}, 1);
  EXPECT_NEAR(glm::length(looking(camera) - start * glm::dvec3(0, 0, -1)), 0, 1e-12);
  EXPECT_EQ(camera.pose().position, glm::dvec3(1, 2, 3));
}

TEST(WalkCamera, LookingStraightUpKeepsItsHeading) {
  const glm::dquat start = glm::angleAxis(0.8, glm::dvec3(0, 1, 0)) * glm::angleAxis(kHalfPi, glm::dvec3(1, 0, 0));
  WalkCamera camera({{0, 0, 0}, start}, 1);
  camera.advance({.forward = 1}, 1);
  EXPECT_NEAR(camera.pose().position.x, -std::sin(0.8), 1e-6);
  EXPECT_NEAR(camera.pose().position.z, -std::cos(0.8), 1e-6);
}

TEST(WalkCamera, WalkingStaysLevelFlyingFollowsTheView) {
  const Pose down{{0, 10, 0}, glm::angleAxis(-0.5, glm::dvec3(1, 0, 0))};
  WalkCamera walker(down, 2);
  walker.advance({.forward = 1}, 3);
  EXPECT_NEAR(walker.pose().position.y, 10, 1e-12);
  EXPECT_NEAR(walker.pose().position.z, -6, 1e-12);
  WalkCamera flyer(down, 2);
  flyer.toggle_flying();
  flyer.advance({.forward = 1}, 3);
  EXPECT_NEAR(flyer.pose().position.y, 10 - 6 * std::sin(0.5), 1e-12);
}

TEST(WalkCamera, DiagonalsAreNotFaster) {
  WalkCamera camera({}, 1);
  camera.advance({.forward = 1, .right = 1}, 1);
  EXPECT_NEAR(glm::length(camera.pose().position), 1, 1e-12);
}

TEST(WalkCamera, NeverTurnsOverItsHead) {
  WalkCamera camera({}, 1);
  for (int i = 0; i < 100; ++i) camera.advance({.look_right_px = 37, .look_down_px = -1000}, 0.01);
  EXPECT_NEAR(looking(camera).y, 1, 1e-9);
  const glm::dvec3 right = camera.pose().world_from_camera * glm::dvec3(1, 0, 0);
  EXPECT_NEAR(right.y, 0, 1e-9);
}

TEST(WalkCamera, WheelChangesTheSpeedWithinBounds) {
  WalkCamera camera({}, 1);
  camera.advance({.wheel_steps = 1}, 0);
  EXPECT_NEAR(camera.speed_m_s(), 1.25, 1e-12);
  camera.advance({.wheel_steps = 1000}, 0);
  EXPECT_TRUE(std::isfinite(camera.speed_m_s()));
  camera.advance({.wheel_steps = -100000}, 0);
  EXPECT_GT(camera.speed_m_s(), 0);
}

}  // namespace
}  // namespace farfield::client

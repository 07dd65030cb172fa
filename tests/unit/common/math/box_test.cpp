// SPDX-License-Identifier: Apache-2.0
#include "common/math/box.h"

#include <gtest/gtest.h>

#include <random>

#include "common/math/camera.h"

namespace farfield {
namespace {

TEST(Box, StartsEmptyAndGrowsToWhatItIncludes) {
  Box box;
  EXPECT_TRUE(box.is_empty());
  EXPECT_DOUBLE_EQ(box.extent().x, 0);
  box.include(glm::dvec3(1, 2, 3));
  EXPECT_FALSE(box.is_empty());
  box.include(glm::dvec3(-1, 5, 3));
  EXPECT_DOUBLE_EQ(box.extent().x, 2);
  EXPECT_DOUBLE_EQ(box.center().y, 3.5);
  Box other;
  box.include(other);  // an empty box adds nothing
  EXPECT_DOUBLE_EQ(box.extent().y, 3);
}

TEST(Box, IsHalfOpenForPointsAndClosedForBoxes) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(box.contains(glm::dvec3(0, 0, 0)));
  EXPECT_FALSE(box.contains(glm::dvec3(1, 0.5, 0.5)));
  EXPECT_TRUE(box.contains(box));
  EXPECT_TRUE(box.intersects(Box{{1, 0, 0}, {2, 1, 1}}));
  EXPECT_FALSE(box.intersects(Box{{1.001, 0, 0}, {2, 1, 1}}));
  EXPECT_TRUE(box.grown(0.5).contains(glm::dvec3(-0.5, 1.4, 0)));
}

TEST(Box, ExitDistanceEndsOnTheSurface) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const Box box{{-1, -2, -3}, {2, 3, 1}};
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 origin{coordinate(random), coordinate(random), coordinate(random)};
    const glm::dvec3 direction{coordinate(random), coordinate(random), coordinate(random)};
    const double t = exit_distance(box, origin, direction);
    EXPECT_TRUE(box.grown(1e-9).contains(origin + t * direction));
    EXPECT_FALSE(box.contains(origin + (t + 1e-6) * direction));
    EXPECT_TRUE(box.contains(origin + 0.999 * t * direction));
  }
  EXPECT_TRUE(std::isinf(exit_distance(box, {0, 0, 0}, {0, 0, 0})));
  EXPECT_DOUBLE_EQ(exit_distance(box, {0, 0, 0}, {0, -2, 0}), 1.0);
  EXPECT_DOUBLE_EQ(exit_distance(box, {2, 0, 0}, {1, 0, 0}), 0.0);
}

TEST(Display, PixelPitchAndDirectionsAgree) {
  const Display display;
  EXPECT_NEAR(display.pixel_pitch(), 2 * std::tan(0.5 * display.fovy_rad) / 720, 1e-15);
  const glm::dvec3 top = camera_direction(display, 0.5 * display.width, 0);
  EXPECT_NEAR(top.x, 0, 1e-12);
  EXPECT_NEAR(top.y, display.tan_half(), 1e-12);
  EXPECT_DOUBLE_EQ(top.z, -1);
  EXPECT_LT(camera_direction(display, 0, display.height).x, 0);
  EXPECT_LT(camera_direction(display, 0, display.height).y, 0);
}

}  // namespace
}  // namespace farfield

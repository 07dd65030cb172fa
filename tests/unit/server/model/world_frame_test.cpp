// SPDX-License-Identifier: Apache-2.0
#include "server/model/world_frame.h"

#include <gtest/gtest.h>

#include <limits>

namespace farfield {
namespace {

glm::dvec3 placed(const glm::dmat4& world, glm::dvec3 p) {
  return glm::dvec3(world * glm::dvec4(p, 1));
}

TEST(WorldFrame, TurnsTheUpAxisIntoY) {
  EXPECT_EQ(placed(*world_from_file(1, "y", {0, 0, 0}), {1, 2, 3}), glm::dvec3(1, 2, 3));
  EXPECT_EQ(placed(*world_from_file(1, "z", {0, 0, 0}), {1, 2, 3}), glm::dvec3(1, 3, -2));
  EXPECT_EQ(placed(*world_from_file(1, "x", {0, 0, 0}), {1, 2, 3}), glm::dvec3(-2, 1, 3));
}

TEST(WorldFrame, StaysRightHanded) {
  for (const char* up : {"x", "y", "z"}) {
    EXPECT_DOUBLE_EQ(glm::determinant(glm::dmat3(*world_from_file(1, up, {5, 6, 7}))), 1.0) << up;
  }
}

TEST(WorldFrame, ScalesBeforeItShifts) {
  EXPECT_EQ(placed(*world_from_file(0.5, "y", {-84000, 0, 447000}), {168000, 2, -4}), glm::dvec3(0, 1, 446998));
}

TEST(WorldFrame, RefusesWhatCannotBeMeant) {
  EXPECT_EQ(world_from_file(0, "y", {0, 0, 0}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_FALSE(world_from_file(-1, "y", {0, 0, 0}));
  EXPECT_FALSE(world_from_file(std::numeric_limits<double>::infinity(), "y", {0, 0, 0}));
  EXPECT_FALSE(world_from_file(1, "w", {0, 0, 0}));
  EXPECT_FALSE(world_from_file(1, "y", {std::numeric_limits<double>::quiet_NaN(), 0, 0}));
}

}  // namespace
}  // namespace farfield

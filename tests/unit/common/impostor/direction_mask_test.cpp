// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/direction_mask.h"

#include <gtest/gtest.h>

#include <random>

namespace farfield {
namespace {

TEST(DirectionMask, ShareOfSkyHoldsForEveryPixelOfTheRectangle) {
  std::mt19937 random(7);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const Display display{640, 360, 1.1};
  int all = 0, none = 0, unknown = 0;
  for (int trial = 0; trial < 40; ++trial) {
    DirectionMask mask;  // a cap of directions, as the sky is seen above an edge
    const glm::dvec3 middle(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    for (int k = 0; k < 20000; ++k) {
      const glm::dvec3 direction(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (glm::dot(direction, middle) > 0.3) mask.insert(direction);
    }
    const glm::dquat turn = glm::normalize(glm::dquat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
    const SkyTest sky(mask, glm::mat3_cast(turn), display);
    for (int k = 0; k < 100; ++k) {
      const int left = static_cast<int>(random() % 632), top = static_cast<int>(random() % 352);
      const DirectionMask::Share share = sky.share_of_sky(left, left + 7, top, top + 7);
      int pixels = 0;
      for (int y = top; y < top + 8; ++y)
        for (int x = left; x < left + 8; ++x) pixels += sky.may_be_sky(x, y);
      ASSERT_TRUE(share != DirectionMask::Share::kAll || pixels == 64);
      ASSERT_TRUE(share != DirectionMask::Share::kNone || pixels == 0);
      all += share == DirectionMask::Share::kAll;
      none += share == DirectionMask::Share::kNone;
      unknown += share == DirectionMask::Share::kUnknown;
    }
  }
  EXPECT_GT(all, 500);
  EXPECT_GT(none, 500);
  EXPECT_LT(unknown, 2000);
}

}  // namespace
}  // namespace farfield

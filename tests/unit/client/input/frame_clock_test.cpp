// SPDX-License-Identifier: Apache-2.0
#include "client/input/frame_clock.h"

#include <gtest/gtest.h>

namespace farfield::client {
namespace {

TEST(FrameClock, QuantilesAreExact) {
  FrameClock clock;
  EXPECT_EQ(clock.quantile_ms(0.5), 0);
  for (int i = 100; i >= 0; --i) clock.add(i);
  EXPECT_EQ(clock.quantile_ms(0.5), 50);
  EXPECT_EQ(clock.quantile_ms(0.99), 99);
  EXPECT_EQ(clock.quantile_ms(1), 100);
  EXPECT_EQ(clock.frames(), 101u);
}

}  // namespace
}  // namespace farfield::client

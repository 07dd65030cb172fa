// SPDX-License-Identifier: Apache-2.0
#include "client/load/latency_samples.h"

#include <gtest/gtest.h>

#include <cmath>

namespace farfield::client {
namespace {

TEST(LatencySamples, PercentilesAreSamplesByNearestRank) {
  LatencySamples samples;
  for (int k = 1000; k >= 1; --k) samples.add(k);
  const Percentiles p = samples.percentiles();
  EXPECT_DOUBLE_EQ(p.p50, 500);
  EXPECT_DOUBLE_EQ(p.p90, 900);
  EXPECT_DOUBLE_EQ(p.p95, 950);
  EXPECT_DOUBLE_EQ(p.p99, 990);
  EXPECT_DOUBLE_EQ(p.p999, 999);
  EXPECT_DOUBLE_EQ(p.max, 1000);
}

TEST(LatencySamples, OneSampleIsAllOfThemAndNoneIsNone) {
  LatencySamples one, none;
  one.add(0.25);
  EXPECT_DOUBLE_EQ(one.percentiles().p50, 0.25);
  EXPECT_DOUBLE_EQ(one.percentiles().p999, 0.25);
  EXPECT_TRUE(std::isnan(none.percentiles().p50));
  none.add(one);
  EXPECT_DOUBLE_EQ(none.percentiles().max, 0.25);
}

}  // namespace
}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/frame/mix_frames.h"

#include <gtest/gtest.h>

namespace farfield::client {
namespace {

constexpr int kEdge = 16;

Frame plain(std::uint8_t level, Coverage coverage) {
  Frame frame;
  frame.width = frame.height = kEdge;
  frame.rgba.assign(4 * frame.pixels(), level);
  for (std::size_t p = 0; p < frame.pixels(); ++p) frame.rgba[4 * p + 3] = 255;
  frame.disparity.assign(frame.pixels(), level / 256.0f);
  frame.coverage.assign(frame.pixels(), coverage);
  if (coverage == Coverage::kVoidFilled) frame.statistics.void_pixels = frame.pixels();
  return frame;
}

double mean_red(const Frame& frame) {
  double sum = 0;
  for (std::size_t p = 0; p < frame.pixels(); ++p) sum += frame.rgba[4 * p];
  return sum / static_cast<double>(frame.pixels());
}

TEST(MixFrames, TheEndsAreExactAndBetweenThemTheMeanIs) {
  const Frame former = plain(40, Coverage::kNear);
  for (const std::uint8_t level : {0, 40, 41, 255}) {
    for (const double share : {0.0, 0.25, 0.5, 0.8125, 1.0}) {
      Frame newest = plain(level, Coverage::kImpostor);
      mix_frames(former, share, newest);
      EXPECT_NEAR(mean_red(newest), (1 - share) * 40 + share * level, 1e-9) << int{level} << " " << share;
      EXPECT_EQ(newest.rgba[3], 255);
      EXPECT_EQ(newest.coverage[0], Coverage::kImpostor);
      EXPECT_EQ(newest.disparity[0], level / 256.0f);
    }
  }
}

TEST(MixFrames, AStepOfOneLevelIsTakenByOnePixelAfterTheOther) {
  const Frame former = plain(100, Coverage::kNear);
  double last = 100;
  for (int k = 1; k <= 64; ++k) {
    Frame newest = plain(101, Coverage::kNear);
    mix_frames(former, k / 64.0, newest);
    EXPECT_NEAR(mean_red(newest) - last, 1.0 / 64, 1e-9) << k;
    last = mean_red(newest);
  }
}

TEST(MixFrames, WhoKnowsIsBelievedBeforeWhoGuesses) {
  Frame newest = plain(200, Coverage::kVoidFilled);
  mix_frames(plain(40, Coverage::kImpostor), 0.75, newest);
  EXPECT_EQ(mean_red(newest), 40);
  EXPECT_EQ(newest.coverage[5], Coverage::kImpostor);
  EXPECT_EQ(newest.disparity[5], 40 / 256.0f);
  EXPECT_EQ(newest.statistics.void_pixels, 0u);

  newest = plain(200, Coverage::kImpostor);
  mix_frames(plain(40, Coverage::kVoidFilled), 0.25, newest);
  EXPECT_EQ(mean_red(newest), 200);

  newest = plain(200, Coverage::kVoidFilled);
  mix_frames(plain(40, Coverage::kVoidFilled), 0.5, newest);
  EXPECT_EQ(mean_red(newest), 120);
  EXPECT_EQ(newest.statistics.void_pixels, newest.pixels());
}

}  // namespace
}  // namespace farfield::client

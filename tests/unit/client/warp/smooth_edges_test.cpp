// SPDX-License-Identifier: Apache-2.0
#include "client/warp/smooth_edges.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr int kWidth = 150, kHeight = 110;  // several bands, none of them whole
constexpr float kFar = 0.05f, kNear = 0.4f;
constexpr std::uint8_t kDark = 40, kBright = 220;

/// `is_near(x, y)` of points in pixels decides which of two surfaces is seen, at the pixels' middles.
using IsNear = std::function<bool(double, double)>;

Frame drawn(const IsNear& is_near) {
  Frame frame;
  frame.width = kWidth, frame.height = kHeight;
  frame.rgba.assign(4 * frame.pixels(), 255);
  frame.disparity.resize(frame.pixels());
  frame.coverage.assign(frame.pixels(), Coverage::kNear);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * kWidth + x;
      const bool near = is_near(x + 0.5, y + 0.5);
      frame.disparity[at] = near ? kNear : kFar;
      for (int c = 0; c < 3; ++c) frame.rgba[4 * at + c] = near ? kBright : kDark;
    }
  return frame;
}

/// Squared error, in codes, against 16×16 samples averaged in linear light.
double squared_error(const Frame& frame, const IsNear& is_near) {
  constexpr int kFine = 16;
  const float bright = srgb_to_linear(kBright), dark = srgb_to_linear(kDark);
  double sum = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      int hits = 0;
      for (int k = 0; k < kFine * kFine; ++k) hits += is_near(x + (k % kFine + 0.5) / kFine, y + (k / kFine + 0.5) / kFine);
      const float share = static_cast<float>(hits) / (kFine * kFine);
      const double off = frame.rgba[4 * (static_cast<std::size_t>(y) * kWidth + x)] - linear_to_srgb(dark + share * (bright - dark));
      sum += off * off;
    }
  return sum;
}

Frame smoothed(Frame frame, int threads = 1) {
  EdgeSmoother smoother;
  tbb::task_arena(threads).execute([&] { smoother.smooth(frame); });
  return frame;
}

class StraightSilhouette : public testing::TestWithParam<double> {};

TEST_P(StraightSilhouette, LosesMostOfItsStaircase) {
  const double angle = GetParam(), nx = std::cos(angle), ny = std::sin(angle);
  const IsNear is_near = [=](double x, double y) { return nx * (x - 71.3) + ny * (y - 52.1) > 0; };
  const Frame before = drawn(is_near);
  EXPECT_LT(squared_error(smoothed(before), is_near), 0.25 * squared_error(before, is_near));
}

// Along the axes and the diagonals there is nothing that a line through steps could tell.
INSTANTIATE_TEST_SUITE_P(Angles, StraightSilhouette, testing::Values(0.07, 0.2, 0.35, 1.2, 1.45, 1.7, 2.9, 3.3, 4.5, 6.1));

TEST(EdgeSmootherTest, BringsARoundSilhouetteNearerToTruth) {
  const IsNear is_near = [](double x, double y) { return std::hypot(x - 70.2, y - 55.7) < 41.3; };
  const Frame before = drawn(is_near);
  EXPECT_LT(squared_error(smoothed(before), is_near), 0.4 * squared_error(before, is_near));
}

TEST(EdgeSmootherTest, LeavesTexturesAlone) {
  Frame frame = drawn([](double, double) { return true; });
  std::mt19937 random(7);
  for (std::size_t at = 0; at < frame.pixels(); ++at) {
    // A floor up to the horizon: disparity is linear in the row.
    frame.disparity[at] = 0.002f * static_cast<float>(at / kWidth);
    for (int c = 0; c < 3; ++c) frame.rgba[4 * at + c] = static_cast<std::uint8_t>(random());
  }
  EXPECT_EQ(smoothed(frame).rgba, frame.rgba);
}

TEST(EdgeSmootherTest, DoesNotDependOnThreads) {
  Frame frame = drawn([](double x, double y) { return std::sin(0.2 * x) * 20 + std::sin(0.31 * y) * 9 + y > 0.7 * x; });
  EXPECT_EQ(smoothed(frame, 4).rgba, smoothed(frame, 1).rgba);
}

TEST(EdgeSmootherTest, TreatsColumnsAsItTreatsRows) {
  const auto square = [](const Frame& frame) {  // both have these columns and rows
    std::vector<std::uint8_t> out;
    for (int y = 20; y < 90; ++y)
      for (int x = 20; x < 90; ++x) out.push_back(frame.rgba[4 * (static_cast<std::size_t>(y) * kWidth + x)]);
    return out;
  };
  const auto turned = [](const Frame& frame) {
    std::vector<std::uint8_t> out;
    for (int y = 20; y < 90; ++y)
      for (int x = 20; x < 90; ++x) out.push_back(frame.rgba[4 * (static_cast<std::size_t>(x) * kWidth + y)]);
    return out;
  };
  const IsNear is_near = [](double x, double y) { return 0.13 * (x - 55) > y - 55; };
  const Frame rows = smoothed(drawn(is_near)), columns = smoothed(drawn([&](double x, double y) { return is_near(y, x); }));
  EXPECT_NE(square(rows), square(drawn(is_near)));
  const auto across = square(rows), down = turned(columns);
  for (std::size_t at = 0; at < across.size(); ++at) ASSERT_NEAR(across[at], down[at], 1);  // sums in another order
}

TEST(EdgeSmootherTest, ChangesColoursOnly) {
  const Frame before = drawn([](double x, double y) { return 0.3 * x > y; });
  const Frame after = smoothed(before);
  EXPECT_EQ(after.disparity, before.disparity);
  EXPECT_EQ(after.coverage, before.coverage);
  for (std::size_t at = 0; at < after.pixels(); ++at) ASSERT_EQ(after.rgba[4 * at + 3], 255);
}

TEST(EdgeSmootherTest, TakesFramesOfAnySize) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 40), std::pair(40, 1), std::pair(2, 2), std::pair(3, 2), std::pair(9, 33)}) {
    Frame frame;
    frame.width = width, frame.height = height;
    std::mt19937 random(3);
    for (std::size_t at = 0; at < frame.pixels(); ++at) {
      for (int c = 0; c < 3; ++c) frame.rgba.push_back(static_cast<std::uint8_t>(random()));
      frame.rgba.push_back(255);
      frame.disparity.push_back(random() % 3 == 0 ? 0.0f : static_cast<float>(random() % 100));
      frame.coverage.push_back(Coverage::kImpostor);
    }
    EXPECT_EQ(smoothed(frame).rgba.size(), frame.rgba.size());
  }
}

}  // namespace
}  // namespace farfield::client

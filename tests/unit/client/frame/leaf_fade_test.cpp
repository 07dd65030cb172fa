// SPDX-License-Identifier: Apache-2.0
#include "client/frame/leaf_fade.h"

#include <gtest/gtest.h>

namespace farfield::client {
namespace {

constexpr double kSide = 2.0;
constexpr double kFrame = 1.0 / 60;

/// Complete; its box is kSide wide and begins at x = kSide·column.
std::shared_ptr<LeafView> leaf_at(int column) {
  auto leaf = std::make_shared<LeafView>();
  leaf->leaf.x = column;
  leaf->leaf_box = Box{{kSide * column, 0, 0}, {kSide * (column + 1), kSide, kSide}};
  leaf->is_complete = true;
  return leaf;
}

glm::dvec3 at(double x) { return {x, 1, 1}; }

TEST(LeafFade, GivesWayWithinItsTimeSlowlyAtBothEnds) {
  LeafFade fade(14.5 * kFrame);
  const auto first = leaf_at(0), second = leaf_at(1);
  EXPECT_EQ(fade.next(first, at(1.9), 0).former, nullptr);
  double share = 0, largest_step = 0;
  int frames = 0;
  for (double t = kFrame; share < 1; t += kFrame, ++frames) {
    ASSERT_LT(frames, 20);
    const LeafFade::Mix mix = fade.next(second, at(2.01), t);
    ASSERT_EQ(mix.shown, second);
    EXPECT_EQ(mix.former, mix.share < 1 ? first : nullptr);
    EXPECT_GT(mix.share, share);
    EXPECT_TRUE(frames > 0 || mix.share < 0.02);
    largest_step = std::max(largest_step, mix.share - share);
    share = mix.share;
  }
  EXPECT_EQ(frames, 15);
  EXPECT_LT(largest_step, 0.11);
}

TEST(LeafFade, AFrameThatComesLateIsFartherAlong) {
  LeafFade fade(0.25);
  fade.next(leaf_at(0), at(1.9), 0);
  EXPECT_NEAR(fade.next(leaf_at(1), at(2.01), 0.125).share, 0.5, 1e-9);
  fade.next(leaf_at(1), at(2.01), 0.4);
  EXPECT_EQ(fade.next(leaf_at(0), at(1.9), 0.7).former, nullptr);  // longer than a fade since the last frame
}

TEST(LeafFade, WithoutATimeOrAnEndToItEverySetIsShownAtOnce) {
  LeafFade never(0), timeless(0.25);
  never.next(leaf_at(0), at(1.9), 0), timeless.next(leaf_at(0), at(1.9), {});
  EXPECT_EQ(never.next(leaf_at(1), at(2.1), kFrame).former, nullptr);
  EXPECT_EQ(timeless.next(leaf_at(1), at(2.1), {}).former, nullptr);
  LeafFade clock_set_back(0.25);
  clock_set_back.next(leaf_at(0), at(1.9), 10);
  EXPECT_EQ(clock_set_back.next(leaf_at(1), at(2.1), 9).former, nullptr);
}

TEST(LeafFade, WhatIsNotWholeIsNeitherFadedFromNorTo) {
  for (const bool is_fallback : {false, true}) {
    for (const bool is_first : {false, true}) {
      LeafFade fade(0.25);
      const auto first = leaf_at(0), second = leaf_at(1);
      (is_fallback ? (is_first ? first : second)->is_fallback : (is_first ? first : second)->is_complete) = is_fallback;
      fade.next(first, at(1.9), 0);
      const LeafFade::Mix mix = fade.next(second, at(2.1), kFrame);
      EXPECT_EQ(mix.shown, second);
      EXPECT_EQ(mix.former, nullptr);
    }
  }
}

TEST(LeafFade, AFullerVersionOfTheSameSetDoesNotBeginAnew) {
  LeafFade fade(0.25);
  const auto first = leaf_at(0), second = leaf_at(1), fuller = leaf_at(1);
  fade.next(first, at(1.9), 0);
  const double before = fade.next(second, at(2.01), 0.1).share;
  const LeafFade::Mix mix = fade.next(fuller, at(2.02), 0.1 + kFrame);
  EXPECT_EQ(mix.shown, fuller);
  EXPECT_EQ(mix.former, first);
  EXPECT_GT(mix.share, before);
}

TEST(LeafFade, ASetThatArrivesDuringAFadeHasItsTurnAfterwards) {
  LeafFade fade(0.25);
  const auto first = leaf_at(0), second = leaf_at(1), third = leaf_at(1);
  third->leaf.z = 1;
  third->leaf_box.min.z += kSide, third->leaf_box.max.z += kSide;
  const auto beyond_corner = [](double x) { return glm::dvec3(x, 1, kSide + 0.01); };
  fade.next(first, at(1.9), 0);
  fade.next(second, at(2.01), 0.1);
  const LeafFade::Mix during = fade.next(third, beyond_corner(2.02), 0.2);
  EXPECT_EQ(during.shown, second);
  EXPECT_EQ(during.former, first);
  const LeafFade::Mix after = fade.next(third, beyond_corner(2.03), 0.26);
  EXPECT_EQ(after.shown, third);
  EXPECT_EQ(after.former, second);
  EXPECT_LT(after.share, 0.2);
}

TEST(LeafFade, WhoRunsIsFartherAlongThanTheClock) {
  LeafFade fade(0.25);
  fade.next(leaf_at(0), at(1.9), 0);
  EXPECT_LT(fade.next(leaf_at(1), at(2.01), kFrame).share, 0.02);
  EXPECT_NEAR(fade.next(leaf_at(1), at(2 + 0.5 * kSide), 2 * kFrame).share, 0.5, 1e-9);
}

TEST(LeafFade, OnlyWhatMayStillBeDrawnIsInUse) {
  using Sets = std::vector<std::shared_ptr<const LeafView>>;
  LeafFade fade(0.25), never(0);
  const auto first = leaf_at(0), second = leaf_at(1);
  EXPECT_EQ(fade.in_use(0), Sets());
  fade.next(first, at(1.9), 0), never.next(first, at(1.9), 0);
  EXPECT_EQ(fade.in_use(kFrame), Sets{first});
  EXPECT_EQ(fade.in_use({}), Sets());
  EXPECT_EQ(fade.in_use(1), Sets());  // frames so far apart do not fade
  EXPECT_EQ(never.in_use(kFrame), Sets());
  fade.next(second, at(2.01), kFrame);
  EXPECT_EQ(fade.in_use(2 * kFrame), (Sets{second, first}));
  fade.next(second, at(2.02), 0.2), fade.next(second, at(2.03), 0.4);
  EXPECT_EQ(fade.in_use(0.41), Sets{second});
}

TEST(LeafFade, WhatIsTooFarGoneIsNotShown) {
  const auto first = leaf_at(0), second = leaf_at(1), far_away = leaf_at(50);
  LeafFade jumps(0.25);
  jumps.next(first, at(1.9), 0);
  EXPECT_EQ(jumps.next(far_away, at(101), kFrame).former, nullptr);
  LeafFade jumps_while_fading(0.25);
  jumps_while_fading.next(first, at(1.9), 0);
  jumps_while_fading.next(second, at(2.01), 0.1);
  const LeafFade::Mix mix = jumps_while_fading.next(far_away, at(101), 0.12);
  EXPECT_EQ(mix.shown, far_away);
  EXPECT_EQ(mix.former, nullptr);
}

}  // namespace
}  // namespace farfield::client

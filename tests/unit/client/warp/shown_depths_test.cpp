// SPDX-License-Identifier: Apache-2.0
#include "client/warp/shown_depths.h"

#include <gtest/gtest.h>

#include <random>

namespace farfield::client {
namespace {

// Whatever is asked and drawn in between: the answer is that of asking every pixel.
TEST(ShownDepths, AnswersAsThePixelsDo) {
  std::mt19937 random(1);
  constexpr int kWidth = 301;  // more cells in a row than are compared at once
  const PixelWindow window{kWidth, 5, 42};
  std::vector<std::uint64_t> keys(kWidth * 50, kNoSplat);
  ShownDepths shown(window, keys.data());
  const auto below = [&](int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); };
  const auto rectangle = [&](int largest) {
    const int left = below(kWidth), top = 5 + below(37);
    return PixelRectangle{left, std::min(left + below(5 * largest), kWidth - 1), top, std::min(top + below(largest), 41)};
  };
  int hidden = 0, open = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const PixelRectangle drawn = rectangle(30);
    for (int y = drawn.top; y <= drawn.bottom; ++y)
      for (int x = drawn.left; x <= drawn.right; ++x) {
        std::uint64_t& key = keys[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)];
        key = std::max(key, make_key(key_high(static_cast<float>(trial % 500 + below(40)) * 1e-3f), 0));
      }
    shown.drawn(drawn);
    for (int k = 0; k < 4; ++k) {
      const PixelRectangle asked = rectangle(20);
      const float nearest = static_cast<float>(below(600)) * 1e-3f;
      const bool expected = are_hidden(asked, nearest, kWidth, keys.data());
      ++(expected ? hidden : open);
      ASSERT_EQ(shown.hide(asked, nearest), expected);
    }
    if (trial % 500 == 499) {  // from the beginning
      std::fill(keys.begin(), keys.end(), kNoSplat);
      shown = ShownDepths(window, keys.data());
    }
  }
  EXPECT_GT(hidden, 1000);
  EXPECT_GT(open, 1000);
}

}  // namespace
}  // namespace farfield::client

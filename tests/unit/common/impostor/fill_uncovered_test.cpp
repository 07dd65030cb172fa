// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/fill_uncovered.h"

#include <gtest/gtest.h>

namespace farfield {
namespace {

TEST(FillUncovered, KeepsWhatIsCoveredAndContinuesItBeside) {
  constexpr int kSize = 16;
  std::vector<std::uint8_t> rgb(3 * kSize * kSize, 0), coverage(kSize * kSize, 0);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize / 2; ++x) {
      coverage[y * kSize + x] = 1;
      rgb[3 * (y * kSize + x)] = 200, rgb[3 * (y * kSize + x) + 1] = 100;
    }
  const std::vector<std::uint8_t> before = rgb;
  fill_uncovered(rgb, coverage, kSize, kSize);
  for (int i = 0; i < kSize * kSize; ++i) {
    if (coverage[i]) {
      EXPECT_EQ(rgb[3 * i], before[3 * i]);
    } else {
      EXPECT_NEAR(rgb[3 * i], 200, 1);
      EXPECT_NEAR(rgb[3 * i + 1], 100, 1);
      EXPECT_LE(rgb[3 * i + 2], 1);
    }
  }
}

}  // namespace
}  // namespace farfield

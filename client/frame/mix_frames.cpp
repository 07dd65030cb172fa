// SPDX-License-Identifier: Apache-2.0
#include "client/frame/mix_frames.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace farfield::client {
namespace {

/// Bayer's ordered dither: 0 … 63, each once in 8×8 pixels, neighbours far apart.
constexpr unsigned dither_rank(unsigned x, unsigned y) {
  unsigned rank = 0;
  for (unsigned bit = 0; bit < 3; ++bit) rank |= (((x ^ y) >> bit & 1) << 1 | (y >> bit & 1)) << 2 * (2 - bit);
  return rank;
}

/// What is added before the division by 256 instead of one half: the middles of 64 steps.
using DitherTable = std::array<std::array<std::uint8_t, 8>, 8>;
constexpr DitherTable kDither = [] {
  DitherTable table{};
  for (unsigned y = 0; y < 8; ++y)
    for (unsigned x = 0; x < 8; ++x) table[y][x] = static_cast<std::uint8_t>(4 * dither_rank(x, y) + 2);
  return table;
}();

}  // namespace

void mix_frames(const Frame& former, double newest_share, Frame& newest) {
  assert(former.width == newest.width && former.height == newest.height);
  const auto of_newest = static_cast<unsigned>(std::lround(256 * std::clamp(newest_share, 0.0, 1.0))), of_former = 256 - of_newest;
  const auto width = static_cast<std::size_t>(newest.width);
  for (std::size_t p = 0; p < newest.pixels(); ++p) {
    const bool is_guess = newest.coverage[p] == Coverage::kVoidFilled, was_guess = former.coverage[p] == Coverage::kVoidFilled;
    if (was_guess && !is_guess) continue;
    std::uint8_t* colour = &newest.rgba[4 * p];
    const std::uint8_t* before = &former.rgba[4 * p];
    if (is_guess && !was_guess) {
      std::copy_n(before, 4, colour);
      newest.coverage[p] = former.coverage[p], newest.disparity[p] = former.disparity[p];
      --newest.statistics.void_pixels;
      continue;
    }
    const unsigned dither = kDither[p / width % 8][p % width % 8];
    for (int c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>((colour[c] * of_newest + before[c] * of_former + dither) >> 8);
  }
}

}  // namespace farfield::client

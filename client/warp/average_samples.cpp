// SPDX-License-Identifier: Apache-2.0
#include "client/warp/average_samples.h"

#include <tbb/parallel_for.h>

#include <array>
#include <atomic>

#include "client/warp/light_tables.h"

namespace farfield::client {
namespace {

/// Of four samples, the first of the class most of them have; the lower class where two are equally frequent.
int choose_sample(const std::array<Coverage, 4>& classes) {
  std::array<int, 5> counts{};
  for (const Coverage c : classes) ++counts[static_cast<int>(c)];
  int best = 0;
  for (int c = 1; c < 5; ++c) {
    if (counts[c] > counts[best]) best = c;
  }
  for (int k = 0; k < 4; ++k) {
    if (static_cast<int>(classes[k]) == best) return k;
  }
  return 0;
}

}  // namespace

void average_samples(const Frame& fine, Frame& frame) {
  frame.width = fine.width / 2;
  frame.height = fine.height / 2;
  frame.rgba.resize(4 * frame.pixels());
  frame.disparity.resize(frame.pixels());
  frame.coverage.resize(frame.pixels());
  const LightTables& tables = LightTables::get();
  std::atomic<std::uint64_t> voids{0}, background{0}, cracks{0};
  tbb::parallel_for(0, frame.height, [&](int y) {
    std::array<std::uint64_t, 5> counts{};
    for (int x = 0; x < frame.width; ++x) {
      const std::size_t upper = static_cast<std::size_t>(2 * y) * fine.width + 2 * x;
      const std::array<std::size_t, 4> at{upper, upper + 1, upper + fine.width, upper + fine.width + 1};
      const std::size_t to = static_cast<std::size_t>(y) * frame.width + x;
      for (int c = 0; c < 3; ++c) {
        std::uint32_t sum = 0;
        for (const std::size_t from : at) sum += tables.linear[fine.rgba[4 * from + c]];
        frame.rgba[4 * to + c] = tables.code[sum >> 4];
      }
      frame.rgba[4 * to + 3] = 255;
      const std::array<Coverage, 4> classes{fine.coverage[at[0]], fine.coverage[at[1]], fine.coverage[at[2]],
                                            fine.coverage[at[3]]};
      const std::size_t chosen = at[choose_sample(classes)];
      frame.disparity[to] = fine.disparity[chosen];
      frame.coverage[to] = fine.coverage[chosen];
      ++counts[static_cast<int>(frame.coverage[to])];
    }
    voids += counts[static_cast<int>(Coverage::kVoidFilled)];
    background += counts[static_cast<int>(Coverage::kBackground)];
    cracks += counts[static_cast<int>(Coverage::kCrackClosed)];
  });
  frame.statistics.void_pixels = voids;
  frame.statistics.background_pixels = background;
  frame.statistics.crack_pixels = cracks;
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/frame/close_mesh_cracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "common/shading/shading.h"

namespace farfield::client {
namespace {

// As for splats: a floor seen at 4 degrees changes by this share of its disparity over two pixels at 720 lines.
constexpr float kSimilar = 1.0f / 16.0f;

struct Closed {
  std::size_t pixel = 0;
  std::array<std::uint8_t, 3> colour{};
  float disparity = 0;
};

/// The first column in [from, end) that nothing covers, or `end`. Most rows have none: memchr skips 64 at a time.
std::size_t next_uncovered(const Coverage* row, std::size_t from, std::size_t end) {
  if (from >= end) return end;
  const void* found = std::memchr(row + from, static_cast<int>(Coverage::kBackground), end - from);
  return found ? static_cast<std::size_t>(static_cast<const Coverage*>(found) - row) : end;
}

}  // namespace

std::uint64_t close_mesh_cracks(Frame& frame) {
  const std::size_t width = static_cast<std::size_t>(frame.width);
  if (width < 3) return 0;
  std::vector<Closed> closed;  // applied at the end: a closed crack must not close its neighbour
  for (std::size_t y = 1; y + 1 < static_cast<std::size_t>(frame.height); ++y) {
    const Coverage* row = frame.coverage.data() + y * width;
    for (std::size_t x = next_uncovered(row, 1, width - 1); x < width - 1; x = next_uncovered(row, x + 1, width - 1)) {
      const std::size_t at = y * width + x;
      for (const std::size_t step : {std::size_t{1}, width, width + 1, width - 1}) {
        const std::size_t a = at - step, b = at + step;
        if (frame.coverage[a] != Coverage::kImpostor || frame.coverage[b] != Coverage::kImpostor) continue;
        const float da = frame.disparity[a], db = frame.disparity[b];
        if (std::fabs(da - db) > kSimilar * std::max(da, db)) continue;
        Closed c{at, {}, 0.5f * (da + db)};
        for (std::size_t i = 0; i < 3; ++i) {
          c.colour[i] =
              linear_to_srgb(0.5f * (srgb_to_linear(frame.rgba[4 * a + i]) + srgb_to_linear(frame.rgba[4 * b + i])));
        }
        closed.push_back(c);
        break;
      }
    }
  }
  for (const Closed& c : closed) {
    std::copy(c.colour.begin(), c.colour.end(), frame.rgba.begin() + static_cast<std::ptrdiff_t>(4 * c.pixel));
    frame.disparity[c.pixel] = c.disparity;
    frame.coverage[c.pixel] = Coverage::kCrackClosed;
  }
  return closed.size();
}

}  // namespace farfield::client

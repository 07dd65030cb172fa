// SPDX-License-Identifier: Apache-2.0
#include "client/warp/close_cracks.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "client/warp/splat_key.h"

namespace farfield::client {
namespace {

// What a pixel's neighbours see in it: an eye disparity, or kNothing for uncovered pixels and near geometry.
constexpr float kNothing = -1.0f;
// Two sides of a crack differ by at most this share of the larger disparity (a floor seen at 3 degrees changes by as
// much over two pixels at 720 lines); what shows through is farther by at least as much.
constexpr float kSimilar = 1.0f / 16.0f;
constexpr float kMuchNearer = 1.0f + kSimilar;
constexpr int kPairsToOverrule = 3;

/// Disparities of one row with kNothing before and after it.
struct NeighbourRow {
  explicit NeighbourRow(int width) : values(width + 2, kNothing) {}
  std::vector<float> values;

  void load(const std::uint64_t* keys, int width) {
    float* out = values.data() + 1;
    for (int x = 0; x < width; ++x) {
      const std::uint64_t key = keys[x];
      const bool counts = (key != kNoSplat) & !key_is_near(key);
      out[x] = counts ? key_disparity(key) : kNothing;
    }
  }
  void clear() { std::fill(values.begin(), values.end(), kNothing); }
};

struct Rows {
  const float *above, *here, *below;  // each points at the pixel left of column 0
};

/// The neighbour pairs of column x: left-right, up-down, and the diagonals.
inline std::array<std::array<float, 2>, 4> pairs_at(const Rows& r, int x) {
  return {{{r.here[x], r.here[x + 2]},
           {r.above[x + 1], r.below[x + 1]},
           {r.above[x], r.below[x + 2]},
           {r.above[x + 2], r.below[x]}}};
}
inline bool pair_closes(float a, float b, float own) {
  const float low = a < b ? a : b, high = a < b ? b : a;
  return (low > own * kMuchNearer) & (low > own) & (low >= 0.0f) & (high - low <= kSimilar * high);
}

void find_cracks(const Rows& rows, int width, std::uint8_t* is_crack) {
  for (int x = 0; x < width; ++x) {
    const float own = rows.here[x + 1];
    int count = 0;
    count += pair_closes(rows.here[x], rows.here[x + 2], own);
    count += pair_closes(rows.above[x + 1], rows.below[x + 1], own);
    count += pair_closes(rows.above[x], rows.below[x + 2], own);
    count += pair_closes(rows.above[x + 2], rows.below[x], own);
    is_crack[x] = count >= (own < 0.0f ? 1 : kPairsToOverrule);
  }
}

struct Closed {
  std::uint32_t colour = 0;
  float disparity = 0;
};

/// The mean over all pairs that close the crack.
Closed close_crack(const std::uint64_t* keys, std::size_t width, const Rows& rows, int x) {
  const std::array<std::array<std::int64_t, 2>, 4> offsets = {
      {{-1, 1}, {-static_cast<std::int64_t>(width), static_cast<std::int64_t>(width)},
       {-static_cast<std::int64_t>(width) - 1, static_cast<std::int64_t>(width) + 1},
       {-static_cast<std::int64_t>(width) + 1, static_cast<std::int64_t>(width) - 1}}};
  const auto pairs = pairs_at(rows, x);
  std::uint32_t sums[3] = {}, count = 0;
  float disparity = 0;
  for (int p = 0; p < 4; ++p) {
    if (!pair_closes(pairs[p][0], pairs[p][1], rows.here[x + 1])) continue;
    for (const std::int64_t offset : offsets[p]) {
      const std::uint32_t colour = key_colour(keys[offset]);
      for (int c = 0; c < 3; ++c) sums[c] += colour >> (8 * c) & 0xff;
      ++count;
    }
    disparity += pairs[p][0] + pairs[p][1];
  }
  Closed closed;
  for (int c = 0; c < 3; ++c) closed.colour |= ((sums[c] + count / 2) / count) << (8 * c);
  closed.disparity = disparity / static_cast<float>(count);
  return closed;
}

/// Everything but the cracks. Returns: how many pixels nothing landed on.
std::uint32_t copy_row(const std::uint64_t* keys, int width, std::uint32_t background, std::uint32_t* rgba,
                       float* disparity, Coverage* coverage) {
  std::uint32_t uncovered = 0;
  for (int x = 0; x < width; ++x) {
    const std::uint64_t key = keys[x];
    const bool is_empty = key == kNoSplat;
    rgba[x] = (is_empty ? background : key_colour(key)) | 0xff000000u;
    disparity[x] = key_disparity(key);
    const int covered = key_is_near(key) ? static_cast<int>(Coverage::kNear) : static_cast<int>(Coverage::kImpostor);
    coverage[x] = static_cast<Coverage>(is_empty ? static_cast<int>(Coverage::kBackground) : covered);
    uncovered += is_empty;
  }
  return uncovered;
}

}  // namespace

ResolveCounts resolve_rows(const std::uint64_t* keys, int first_row, int last_row, std::uint32_t background,
                           Frame& frame) {
  const int width = frame.width;
  const auto stride = static_cast<std::size_t>(width);
  NeighbourRow above(width), here(width), below(width);
  std::vector<std::uint8_t> is_crack(stride + 1);
  std::vector<std::uint32_t> colours(stride);
  const auto load = [&](NeighbourRow& row, int y) {
    if (y >= 0 && y < frame.height) {
      row.load(keys + y * stride, width);
    } else {
      row.clear();
    }
  };
  ResolveCounts counts;
  load(here, first_row - 1);
  load(below, first_row);
  for (int y = first_row; y < last_row; ++y) {
    std::swap(above, here);
    std::swap(here, below);
    load(below, y + 1);
    const std::uint64_t* row_keys = keys + y * stride;
    float* disparity = frame.disparity.data() + y * stride;
    Coverage* coverage = frame.coverage.data() + y * stride;
    counts.uncovered_pixels += copy_row(row_keys, width, background, colours.data(), disparity, coverage);

    const Rows rows{above.values.data(), here.values.data(), below.values.data()};
    find_cracks(rows, width, is_crack.data());
    const auto next_crack = [&](int x) {  // cracks are rare: they are looked for many pixels at once
      const auto* found = static_cast<const std::uint8_t*>(std::memchr(&is_crack[x], 1, stride + 1 - x));
      return static_cast<int>(found - is_crack.data());
    };
    is_crack[width] = 1;  // found at the latest
    for (int x = next_crack(0); x < width; x = next_crack(x + 1)) {
      if (coverage[x] == Coverage::kNear) continue;
      const Closed closed = close_crack(row_keys + x, stride, rows, x);
      counts.uncovered_pixels -= coverage[x] == Coverage::kBackground;
      ++counts.crack_pixels;
      colours[x] = closed.colour | 0xff000000u;
      disparity[x] = closed.disparity;
      coverage[x] = Coverage::kCrackClosed;
    }
    std::memcpy(frame.rgba.data() + 4 * y * stride, colours.data(), 4 * stride);
  }
  return counts;
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "common/codec/colour_quantiser.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace farfield {
namespace {

constexpr int kCoefficients = kBlockSamples * kBlockSamples;

// All in steps. What a bit is worth of squared error: a uniform quantiser's error is step²/12 and falls by 6 dB a bit, so
// ln 4/12 = 0.116 step² at the last. A coefficient v < 1.5 sent as 1 saves v² - (v - 1)² = 2v - 1 of error: it is worth it
// from v = 1/2 + 0.058·bits.
constexpr float kBitWorth = 0.058f;
// One rather than two bits of a larger magnitude: from the same reasoning, two thirds of a bit more than ½ + 0.058.
constexpr float kRoundUp = 0.4f;
constexpr float kLikely = 0.66f;  // coefficients from here count when the tile's statistics are taken
constexpr int kFillRounds = 3;
constexpr int kFlat = -1;  // instead of a count: nothing but the mean is sent

// Sums of a block are taken in eight columns first, side by side, and then over these: the same on every machine.
float sum_of(const BlockRow& columns) {
  return ((columns[0] + columns[4]) + (columns[2] + columns[6])) + ((columns[1] + columns[5]) + (columns[3] + columns[7]));
}

// Requires: 0 where nothing is covered.
float mean_of(const ColourPlane& plane) {
  BlockRow sum{}, row;
  for (int first = 0; first < kCoefficients; first += kBlockSamples) {
    load_row(&plane.samples[first], row);
    sum += row;
  }
  return sum_of(sum) / static_cast<float>(std::popcount(plane.covered));
}

// Which samples of a block are covered, one by one.
using IsCovered = std::array<std::int32_t, kCoefficients>;

IsCovered lanes_of(std::uint64_t covered) {
  IsCovered lanes;
  for (int first = 0; first < kCoefficients; first += kBlockSamples) {
    const auto row = static_cast<std::int32_t>(covered >> first & 0xff);
    for (int lane = 0; lane < kBlockSamples; ++lane) lanes[first + lane] = row >> lane & 1;
  }
  return lanes;
}

// Samples that nobody sees take the values that need the fewest coefficients: those of the block's largest coefficients
// alone, by turns with the covered samples as they are (alternating projections: Papoulis 1975, Gerchberg 1974), while what
// counts as large falls to what will be sent. Requires: the mean where nothing is covered.
void fill_uncovered_samples(const BlockTransform& transform, ColourPlane& plane, const IsCovered& is_covered, const BlockPlane& steps) {
  for (int round = kFillRounds - 1; round >= 0; --round) {
    BlockPlane coefficients = transform.forward(plane.samples);
    const float least = 0.6f + 0.5f * static_cast<float>(round), mean = coefficients[0];
    for (int k = 0; k < kCoefficients; ++k) coefficients[k] = std::abs(coefficients[k]) < least * steps[k] ? 0 : coefficients[k];
    coefficients[0] = mean;
    const BlockPlane smooth = transform.inverse(coefficients);
    for (int k = 0; k < kCoefficients; ++k) plane.samples[k] = is_covered[k] ? plane.samples[k] : smooth[k];
  }
}

// Samples are so near their mean that no coefficient would be sent (Parseval: none is larger than the root of all squares).
bool is_flat(const BlockPlane& samples, float mean, float step) {
  BlockRow squares{}, row;
  for (int first = 0; first < kCoefficients; first += kBlockSamples) {
    load_row(&samples[first], row);
    row -= mean;
    squares += row * row;
  }
  return sum_of(squares) < (0.5f + kBitWorth) * (0.5f + kBitWorth) * step * step;
}

// Puts coefficients, in steps, where the samples were. Returns: whether any but the first is not 0.
bool transform_plane(const BlockTransform& transform, ColourPlane& plane, const BlockPlane& steps) {
  const float mean = mean_of(plane);
  const bool is_whole = ~plane.covered == 0;
  IsCovered is_covered;
  if (!is_whole) {
    is_covered = lanes_of(plane.covered);
    for (int k = 0; k < kCoefficients; ++k) plane.samples[k] = is_covered[k] ? plane.samples[k] : mean;
  }
  if (is_flat(plane.samples, mean, steps[1])) {  // of all but the mean the smallest
    plane.samples.fill(0);
    plane.samples[0] = kBlockSamples * mean / steps[0];
    return false;
  }
  if (!is_whole) fill_uncovered_samples(transform, plane, is_covered, steps);
  plane.samples = transform.forward(plane.samples);
  for (int k = 0; k < kCoefficients; ++k) plane.samples[k] /= steps[k];
  return true;
}

// How often each coefficient of a tile is likely to be sent: what its bits follow from.
class LikelyPlaces {
 public:
  /// Returns: how many of the block's will be.
  int add(const BlockPlane& coefficients) {
    int count = 0;
    for (int k = 0; k < kCoefficients; ++k) {
      const int is_likely = std::abs(coefficients[k]) > kLikely;
      seen_[k] += is_likely, count += is_likely;
    }
    const int is_mean = std::abs(coefficients[0]) > kLikely;  // sent in any case
    seen_[0] -= is_mean, count -= is_mean;
    all_ += count;
    return count;
  }
  /// From what size on coefficient k of a block with `count` likely ones is worth its bits. Once all blocks were added.
  float least(int k, int count) {
    float& known = least_[count][k];
    if (!(known > 0)) known = least_for(k, count);
    return known;
  }
  /// No least() is smaller.
  static constexpr float kSmallest = 0.5f + kBitWorth;

 private:
  float least_for(int k, int count) const {
    const float share = (static_cast<float>(seen_[k]) + 0.5f) / (static_cast<float>(all_) + 0.5f * kCoefficients);
    const float likely = std::clamp((static_cast<float>(count) - 0.5f) * share, 0.003f, 0.9f);
    constexpr float kSignAndSize = 1.5f, kFirstOfBlock = 1.5f;  // bits beside those of the place
    const float bits = std::log2((1 - likely) / likely) + kSignAndSize + (count <= 1 ? kFirstOfBlock : 0);
    return 0.5f + std::max(1.0f, bits) * kBitWorth;
  }

  std::array<std::int32_t, kCoefficients> seen_{};
  std::int32_t all_ = 0;
  std::array<std::array<float, kCoefficients>, kCoefficients> least_{};  // [count][k], as far as they were asked for
};

std::int16_t level_of(float value, float least) {
  const float size = std::abs(value);
  if (size < least) return 0;
  const int level = std::min(std::max(1, static_cast<int>(size + kRoundUp)), kLargestLevel);
  return static_cast<std::int16_t>(value < 0 ? -level : level);
}

}  // namespace

std::vector<ColourBlock> quantise_colours(std::vector<ColourPlane>& planes, const ColourSteps& steps) {
  static const BlockTransform transform;
  std::vector<int> counts(planes.size(), kFlat);
  std::array<LikelyPlaces, 2> places;  // of luma, and of both colour differences
  const auto places_of = [&](std::size_t i) -> LikelyPlaces& { return places[i % kColourPlanes == 0 ? 0 : 1]; };
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (planes[i].covered != 0 && transform_plane(transform, planes[i], steps.of(i % kColourPlanes))) counts[i] = places_of(i).add(planes[i].samples);
  std::vector<ColourBlock> blocks(planes.size() / kColourPlanes);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].covered == 0) continue;
    auto& levels = blocks[i / kColourPlanes].levels[i % kColourPlanes];
    const BlockPlane& values = planes[i].samples;
    levels[0] = static_cast<std::int16_t>(std::clamp(std::lround(values[0]), -long{kLargestLevel}, long{kLargestLevel}));
    if (counts[i] == kFlat) continue;
    for (int k = 1; k < kCoefficients; ++k) {
      const float size = std::abs(values[k]);
      if (size >= LikelyPlaces::kSmallest) levels[k] = level_of(values[k], size < 1.5f ? places_of(i).least(k, counts[i]) : 1.0f);
    }
  }
  return blocks;
}

}  // namespace farfield

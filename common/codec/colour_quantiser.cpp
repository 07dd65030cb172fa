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

float mean_of(const ColourPlane& plane) {
  float sum = 0;
  for (std::uint64_t todo = plane.covered; todo != 0; todo &= todo - 1) sum += plane.samples[std::countr_zero(todo)];
  return sum / static_cast<float>(std::popcount(plane.covered));
}

// Samples that nobody sees take the values that need the fewest coefficients: those of the block's largest coefficients
// alone, by turns with the covered samples as they are (alternating projections: Papoulis 1975, Gerchberg 1974), while what
// counts as large falls to what will be sent.
void fill_uncovered_samples(const BlockTransform& transform, ColourPlane& plane, const BlockPlane& steps) {
  const float mean = mean_of(plane);
  for (std::uint64_t todo = ~plane.covered; todo != 0; todo &= todo - 1) plane.samples[std::countr_zero(todo)] = mean;
  for (int round = kFillRounds - 1; round >= 0; --round) {
    BlockPlane coefficients = transform.forward(plane.samples);
    const float least = 0.6f + 0.5f * static_cast<float>(round);
    for (int k = 1; k < kCoefficients; ++k)
      if (std::abs(coefficients[k]) < least * steps[k]) coefficients[k] = 0;
    const BlockPlane smooth = transform.inverse(coefficients);
    for (std::uint64_t todo = ~plane.covered; todo != 0; todo &= todo - 1) plane.samples[std::countr_zero(todo)] = smooth[std::countr_zero(todo)];
  }
}

// Covered samples are so near their mean that no coefficient would be sent (Parseval: none is larger than the root of all squares).
bool is_flat(const ColourPlane& plane, float mean, float step) {
  float squares = 0;
  for (std::uint64_t todo = plane.covered; todo != 0; todo &= todo - 1) {
    const float off = plane.samples[std::countr_zero(todo)] - mean;
    squares += off * off;
  }
  return squares < (0.5f + kBitWorth) * (0.5f + kBitWorth) * step * step;
}

// Coefficients in steps; all but the first are 0 where the plane is flat.
BlockPlane coefficients_of(const BlockTransform& transform, ColourPlane& plane, const BlockPlane& steps) {
  BlockPlane coefficients{};
  const float mean = mean_of(plane);
  if (is_flat(plane, mean, steps[1])) {  // of all but the mean the smallest
    coefficients[0] = kBlockSamples * mean / steps[0];
    return coefficients;
  }
  if (~plane.covered != 0) fill_uncovered_samples(transform, plane, steps);
  coefficients = transform.forward(plane.samples);
  for (int k = 0; k < kCoefficients; ++k) coefficients[k] /= steps[k];
  return coefficients;
}

// How often each coefficient of a tile is likely to be sent: what its bits follow from.
class LikelyPlaces {
 public:
  /// Returns: how many of the block's will be.
  int add(const BlockPlane& coefficients) {
    int count = 0;
    for (int k = 1; k < kCoefficients; ++k) {
      if (std::abs(coefficients[k]) <= kLikely) continue;
      seen_[k] += 1, all_ += 1, ++count;
    }
    return count;
  }
  /// From what size on coefficient k of a block with `count` likely ones is worth its bits.
  float least(int k, int count) const {
    const float share = (seen_[k] + 0.5f) / (all_ + 0.5f * kCoefficients);
    const float likely = std::clamp((static_cast<float>(count) - 0.5f) * share, 0.003f, 0.9f);
    constexpr float kSignAndSize = 1.5f, kFirstOfBlock = 1.5f;  // bits beside those of the place
    const float bits = std::log2((1 - likely) / likely) + kSignAndSize + (count <= 1 ? kFirstOfBlock : 0);
    return 0.5f + std::max(1.0f, bits) * kBitWorth;
  }

 private:
  std::array<float, kCoefficients> seen_{};
  float all_ = 0;
};

std::int16_t level_of(float value, float least) {
  const float size = std::abs(value);
  if (size < least) return 0;
  const int level = std::min(std::max(1, static_cast<int>(size + kRoundUp)), kLargestLevel);
  return static_cast<std::int16_t>(value < 0 ? -level : level);
}

}  // namespace

std::vector<ColourBlock> quantise_colours(std::vector<ColourPlane>& planes, const ColourSteps& steps) {
  const BlockTransform transform;
  std::vector<BlockPlane> coefficients(planes.size());
  std::vector<int> counts(planes.size());
  std::array<LikelyPlaces, 2> places;  // of luma, and of both colour differences
  const auto places_of = [&](std::size_t i) -> LikelyPlaces& { return places[i % kColourPlanes == 0 ? 0 : 1]; };
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].covered == 0) continue;
    coefficients[i] = coefficients_of(transform, planes[i], steps.of(i % kColourPlanes));
    counts[i] = places_of(i).add(coefficients[i]);
  }
  std::vector<ColourBlock> blocks(planes.size() / kColourPlanes);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    auto& levels = blocks[i / kColourPlanes].levels[i % kColourPlanes];
    const BlockPlane& values = coefficients[i];
    levels[0] = static_cast<std::int16_t>(std::clamp(std::lround(values[0]), -long{kLargestLevel}, long{kLargestLevel}));
    for (int k = 1; k < kCoefficients; ++k) {
      const float size = std::abs(values[k]);
      if (size > 0.5f) levels[k] = level_of(values[k], size < 1.5f ? places_of(i).least(k, counts[i]) : 1.0f);
    }
  }
  return blocks;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// The promise of the disparity codec, |decoded − given| <= tolerance, for any disparities at any tolerance: planes, noise,
// spikes, and values chosen to fall between two levels.
#include <fmt/format.h>

#include <functional>
#include <random>

#include "common/codec/tile_codec.h"
#include "tests/stability/stress.h"

namespace farfield::stability {
namespace {

enum class Pattern { kPlanes, kSteepPlanes, kNoise, kSpikes, kCheckers, kBetweenLevels, kAllMagnitudes, kDenormals, kCount };

double pattern_value(Pattern pattern, int x, int y, double largest, double tolerance, std::mt19937& random) {
  const auto unit = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
  switch (pattern) {
    case Pattern::kPlanes: return largest * (0.3 + 0.002 * x + 0.001 * y);
    case Pattern::kSteepPlanes: return largest * std::abs(std::fmod(0.37 * x - 0.29 * y, 1.0));
    case Pattern::kNoise: return largest * unit();
    case Pattern::kSpikes: return random() % 17 == 0 ? largest : largest * 1e-3;
    case Pattern::kCheckers: return (x + y) % 2 ? largest : 0.0;
    case Pattern::kBetweenLevels:
      return std::min(largest, (std::floor(unit() * largest / tolerance) + 0.5 + 1e-7 * (unit() - 0.5)) * 2 * tolerance * 255 / 256);
    case Pattern::kAllMagnitudes: return largest * std::exp2(-60 * unit());
    default: return std::numeric_limits<float>::denorm_min() * static_cast<double>(random() % 100);
  }
}

// Surfaces of all shapes: whole, in strips of a sample, in single samples, with holes.
void cut_up(Tile& tile, int how, std::mt19937& random) {
  const auto cut = [&](bool is_wanted) { return static_cast<std::uint8_t>(is_wanted ? 1 + random() % 8 : kConnected); };
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    const int x = static_cast<int>(i) % tile.width, y = static_cast<int>(i) / tile.width;
    tile.coverage[i] = how != 3 || random() % 5 != 0;
    tile.cut_right[i] = x + 1 < tile.width ? cut(how == 2 || (how == 1 && x % 3 == 0) || (how == 3 && random() % 4 == 0)) : 0;
    tile.cut_down[i] = y + 1 < tile.height ? cut(how == 2 || how == 1 || (how == 3 && random() % 4 == 0)) : 0;
  }
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    const auto settle = [&](std::uint8_t& at, std::size_t other) {
      if (other >= tile.samples()) return;
      if (!tile.coverage[i] && !tile.coverage[other]) at = 0;
      if (tile.coverage[i] != tile.coverage[other] && at == kConnected) at = 4;
    };
    if (static_cast<int>(i) % tile.width + 1 < tile.width) settle(tile.cut_right[i], i + 1);
    if (static_cast<int>(i) / tile.width + 1 < tile.height) settle(tile.cut_down[i], i + static_cast<std::size_t>(tile.width));
  }
}

Tile tile_of(Pattern pattern, int how, double largest, double tolerance, unsigned seed) {
  std::mt19937 random(seed);
  Tile tile;
  tile.id = {{3, 100, -7, 12}, kIntraView, 2, 1, 2};
  tile.edge_samples = face_samples(4);
  tile.width = tile.height = kTileSamples;
  tile.disparity_tolerance = static_cast<float>(tolerance);
  const std::size_t n = tile.samples();
  tile.coverage.assign(n, 1), tile.disparity.assign(n, 0), tile.rgb.assign(3 * n, 128);
  tile.cut_right.assign(n, 0), tile.cut_down.assign(n, 0);
  cut_up(tile, how, random);
  for (std::size_t i = 0; i < n; ++i)
    if (tile.coverage[i])
      tile.disparity[i] = static_cast<float>(
          pattern_value(pattern, static_cast<int>(i) % kTileSamples, static_cast<int>(i) / kTileSamples, largest, tolerance, random));
  return tile;
}

// Disparities up to 2^ratio tolerances. Floats keep the promise up to 2^15 (kMostTolerances): beyond, the tile says a larger
// tolerance, and keeps that; what it says must not be larger than 2^-15 of its largest disparity.
StressRow any_range(double least_ratio, double most_ratio, const Effort& effort) {
  std::mt19937 random(static_cast<unsigned>(most_ratio));
  WorstError worst;
  for (int trial = 0; trial < (effort.is_full ? 1000 : 64); ++trial) {
    const double tolerance = std::pow(10.0, std::uniform_real_distribution<double>(-11.5, 2.5)(random));
    // No larger than decoders accept: 2^15 times their largest tolerance of 10^3.
    const double ratio = std::min(std::exp2(std::uniform_real_distribution<double>(least_ratio, most_ratio)(random)), 3e7 / tolerance);
    const auto pattern = static_cast<Pattern>(trial % static_cast<int>(Pattern::kCount));
    const Tile tile = tile_of(pattern, trial / 8 % 4, tolerance * ratio, tolerance, static_cast<unsigned>(trial));
    const Result<Bytes> bytes = encode_tile(tile, {});
    const Result<Tile> decoded = bytes ? decode_tile(*bytes) : tl::unexpected(bytes.error());
    if (!decoded || decoded->coverage != tile.coverage) {
      worst.add(INFINITY);
      continue;
    }
    const double allowed = std::max<double>(tile.disparity_tolerance, 0x1.000002p-15 * tolerance * ratio);
    if (decoded->disparity_tolerance > allowed) worst.add(INFINITY);
    for (std::size_t i = 0; i < tile.samples(); ++i) {
      const double off = tile.coverage[i] ? double{decoded->disparity[i]} - double{tile.disparity[i]} : double{decoded->disparity[i]};
      worst.add(off, decoded->disparity_tolerance);
    }
  }
  return worst.row(fmt::format("disparities up to 2^{:g} … 2^{:g} tolerances", least_ratio, most_ratio), "what was encoded", "tolerances",
                   1.0);
}

// What no tile can hold is refused, not coded wrongly.
StressRow impossible_values() {
  WorstError worst;
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float value : {infinity, -infinity, nan, -1e-3f, -std::numeric_limits<float>::denorm_min()}) {
    Tile tile = tile_of(Pattern::kPlanes, 0, 0.4, 1e-3, 1);
    tile.disparity[777] = value;
    worst.count(encode_tile(tile, {}).has_value());
  }
  for (const float tolerance : {0.0f, -1.0f, nan, infinity, std::numeric_limits<float>::denorm_min()}) {
    Tile tile = tile_of(Pattern::kPlanes, 0, 0.4, 1e-3, 1);
    tile.disparity_tolerance = tolerance;
    worst.count(encode_tile(tile, {}).has_value());
  }
  return worst.row("NaN, infinite and negative disparities, impossible tolerances", "a refusal", "accepted", 0);
}

// Damaged bytes, denormal and huge floats in the header included: disparities stay finite and not negative.
StressRow damaged_bytes(const Effort& effort) {
  std::mt19937 random(11);
  const Bytes whole = encode_tile(tile_of(Pattern::kSpikes, 3, 0.4, 1e-3, 5), {}).value();
  WorstError worst;
  for (int trial = 0; trial < (effort.is_full ? 4000 : 200); ++trial) {
    Bytes bytes = whole;
    for (unsigned k = 0; k <= random() % 4; ++k) bytes[random() % (trial % 2 ? bytes.size() : 60)] = static_cast<std::uint8_t>(random());
    const Result<Tile> decoded = decode_tile(bytes);
    if (!decoded) {
      worst.count(false);
      continue;
    }
    for (const float d : decoded->disparity) worst.count(!(d >= 0 && std::isfinite(d)));
  }
  return worst.row("damaged tiles", "finite disparities or an error", "others", 0);
}

}  // namespace

Rows stress_codec(const Effort& effort) {
  return {any_range(-10, 0, effort), any_range(0, 12, effort), any_range(12, 15, effort),
          any_range(15, 60, effort), impossible_values(),      damaged_bytes(effort)};
}

}  // namespace farfield::stability

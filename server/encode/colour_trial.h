// SPDX-License-Identifier: Apache-2.0
// What a tile's colours cost, and how wrong they would be, at one quality or another: without coding the rest of it; and the
// quality at which a byte buys what it buys in all other tiles.
//
// Based on: Y. Shoham & A. Gersho, "Efficient bit allocation for an arbitrary set of quantizers", 1988: the least error for a
// number of bytes is where all tiles have the same slope of error against bytes.
#pragma once

#include <map>

#include "common/codec/surface_colours.h"

namespace farfield {

struct ColourOutcome {
  double bytes = 0;  // of the colour stream and its base colours
  double error = 0;  // squared difference of 8-bit sRGB values, mean over channels, summed over directions: levels²·sr
};

/// What a byte must take off the error to be worth sending, levels²·sr: for the whole shell what coding all of its tiles at
/// `quality` comes to. `edge_samples`: of the intra view.
double slope_of_quality(int quality, int edge_samples);

/// The coarsest and the finest quality that tiles get for a slope.
inline constexpr int kCoarsestQuality = 10, kFinestQuality = 92;

/// Not thread-safe: it remembers what was tried. Differs from the mean over samples: a face's corner has five times the
/// samples of its centre in the same angle, and what is wrong there shows in fewer pixels.
class ColourTrial {
 public:
  /// `tile` must outlive this. Requires: it covers something. O(samples).
  explicit ColourTrial(const Tile& tile);

  /// Codes and decodes the colours the first time: milliseconds. Requires: 1 <= quality <= 100.
  ColourOutcome at(int quality);
  /// Of some twenty qualities the one where weight·error + slope·bytes is least, as far as walking downhill from what theory
  /// expects finds it: three or four trials.
  int best_quality(double slope, double weight);
  /// Covered, as seen from the tile's view, steradians.
  double solid_angle() const { return solid_angle_; }
  /// As an error: had all colours been the tile's mean.
  double spread() const { return spread_; }

 private:
  const Tile& tile_;
  TileBits bits_;
  Surfaces surfaces_;
  std::vector<std::uint8_t> differences_;  // the tile's colours less their bases
  Bytes bases_;
  std::vector<float> angles_;              // steradians of each sample, 0: uncovered
  double solid_angle_ = 0, spread_ = 0;
  std::size_t covered_ = 0;
  std::map<int, ColourOutcome> tried_;
};

}  // namespace farfield

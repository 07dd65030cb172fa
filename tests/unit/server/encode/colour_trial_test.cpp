// SPDX-License-Identifier: Apache-2.0
#include "server/encode/colour_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/codec/tile_codec.h"
#include "server/encode/rate_model.h"

namespace farfield {
namespace {

// One surface, a slope of grey with a pattern of the given strength; of a face of 1514 samples.
Tile patterned(int strength, std::uint8_t x, std::uint8_t y) {
  Tile tile;
  tile.id = {{0, 0, 0, 0}, kIntraView, 0, x, y};
  tile.edge_samples = face_samples(12), tile.width = tile.height = kTileSamples;
  tile.disparity_tolerance = 1e-3f;
  tile.coverage.assign(tile.samples(), 1), tile.disparity.assign(tile.samples(), 0.3f);
  tile.cut_right.assign(tile.samples(), kConnected), tile.cut_down.assign(tile.samples(), kConnected);
  for (int at = 0; at < static_cast<int>(tile.samples()); ++at) {
    const int column = at % kTileSamples, row = at / kTileSamples;
    const auto level = static_cast<std::uint8_t>(100 + column / 4 + strength * std::sin(0.9 * column) * std::cos(0.4 * row + 0.01 * column * row));
    tile.rgb.insert(tile.rgb.end(), {level, level, static_cast<std::uint8_t>(level / 2)});
  }
  return tile;
}

TEST(ColourTrial, TellsWhatCodingTheTileComesTo) {
  const Tile tile = patterned(30, 5, 6);
  ColourTrial trial(tile);
  double finer = std::numeric_limits<double>::infinity(), cheaper = 0;
  for (const int quality : {20, 50, 80, 92}) {
    TileBytes accounting;
    const Tile decoded = decode_tile(encode_tile(tile, {quality}, &accounting).value()).value();
    const ColourOutcome outcome = trial.at(quality);
    EXPECT_EQ(outcome.bytes, accounting.colour) << quality;
    double squares = 0;
    for (std::size_t c = 0; c < tile.rgb.size(); ++c) squares += std::pow(int{tile.rgb[c]} - int{decoded.rgb[c]}, 2);
    // Near a face's middle all samples are alike within some per cent.
    EXPECT_NEAR(outcome.error / trial.solid_angle(), squares / static_cast<double>(tile.rgb.size()), 0.03 * squares / static_cast<double>(tile.rgb.size()));
    EXPECT_LT(outcome.error, finer);
    EXPECT_GT(outcome.bytes, cheaper);
    finer = outcome.error, cheaper = outcome.bytes;
  }
}

TEST(ColourTrial, SolidAnglesOfAFaceAddUpToASixthOfTheSphere) {
  double angle = 0;
  const Tile any = patterned(0, 0, 0);
  for (std::uint8_t y = 0; y < 12; ++y)
    for (std::uint8_t x = 0; x < 12; ++x) {
      Tile tile = any;
      tile.id.x = x, tile.id.y = y;
      angle += ColourTrial(tile).solid_angle();
    }
  const double overlap = std::pow(128.0 / 126, 2);
  EXPECT_NEAR(angle / overlap, 4 * 3.14159265358979 / 6, 0.02);
}

TEST(ColourTrial, BestQualityIsThatOfTheLeastCost) {
  for (const int strength : {3, 30}) {
    const Tile tile = patterned(strength, 5, 6);
    ColourTrial trial(tile);
    int coarser = 101;
    for (const double factor : {0.01, 0.3, 1.0, 10.0, 100.0}) {
      const double slope = factor * slope_of_quality(80, tile.edge_samples);
      const int best = trial.best_quality(slope, 1);
      const auto cost = [&](int quality) { return trial.at(quality).error + slope * trial.at(quality).bytes; };
      for (const int other : {kCoarsestQuality, 29, 50, 65, 80, 88, kFinestQuality}) EXPECT_LE(cost(best), 1.02 * cost(other)) << factor << ' ' << best << ' ' << other;
      EXPECT_LE(best, coarser) << "a steeper slope is never finer";
      EXPECT_LE(trial.best_quality(slope, 0.3), best) << "nor a lighter weight";
      coarser = best;
    }
  }
}

TEST(ColourTrial, SamplesInAFacesCornerAreCodedMoreCoarsely) {
  // The same samples, in less of the view.
  const Tile middle = patterned(30, 5, 6), corner = patterned(30, 0, 0);
  const double slope = slope_of_quality(80, middle.edge_samples);
  EXPECT_LT(ColourTrial(corner).best_quality(slope, 1), ColourTrial(middle).best_quality(slope, 1));
}

TEST(SampledTiles, SpeakForAllTilesAndForEveryView) {
  std::vector<CellNeed> needs;
  double all = 0;
  for (int view = 0; view < 4; ++view)
    for (int k = 0; k < (view == 0 ? 400 : 40 - 10 * view); ++k) {
      CellNeed need{{{0, 1, 2, 3}, static_cast<std::uint8_t>(view), static_cast<std::uint8_t>(k / 100), static_cast<std::uint8_t>(k / 10 % 10), static_cast<std::uint8_t>(k % 10)},
                    1e-3f / static_cast<float>(1 + k % 17), k % 3 ? 1.0f : 0.5f};
      needs.push_back(need), all += need.leaf_share;
    }
  double spoken_for = 0;
  std::vector<int> of_view(4);
  for (const SampledTile& sample : sample_tiles(needs)) {
    spoken_for += sample.count, ++of_view[needs[sample.index].id.view];
    EXPECT_GE(sample.count, needs[sample.index].leaf_share * 0.999);
  }
  EXPECT_NEAR(spoken_for, all, 0.1 * all);
  EXPECT_NEAR(of_view[0], 64, 2);
  for (int view = 1; view < 4; ++view) EXPECT_GE(of_view[view], 3);
  needs.resize(30);
  const auto few = sample_tiles(needs);
  ASSERT_EQ(few.size(), 30u) << "few are all looked at";
  for (const SampledTile& sample : few) EXPECT_EQ(sample.count, needs[sample.index].leaf_share);
}

}  // namespace
}  // namespace farfield

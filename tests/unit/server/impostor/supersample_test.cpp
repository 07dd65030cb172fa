// SPDX-License-Identifier: Apache-2.0
// Colours from several rays: what one ray per sample gets wrong, and what it does not.
#include "server/impostor/supersample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/shading/shading.h"
#include "server/impostor/dense_tile.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::Blocks;
using test::PlacedScene;

constexpr double kWarpGain = 0.98, kTolerance = 1e-4, kWall = 5;
const int kEdge = face_samples(2);
const double kSpacing = kWall * sample_pitch(kEdge);  // of samples on the wall, metres

struct Colours {
  Tile tile;
  TileWork work;
  int level(int i, int j) const { return tile.rgb[3 * (static_cast<std::size_t>(j) * kTileSamples + i)]; }
};

// The first tile of face 0 seen from the origin: samples along u (world y) and v (world z) from -1 to 0.
Colours cast(const PlacedScene& placed) {
  Colours result;
  result.tile = cast_dense_tile(*placed.scene, test::space_around(placed, {0, 0, 0}, 1.0), placed.at(glm::dvec3(0)), {{}, kIntraView, 0, 0, 0},
                                kEdge, kWarpGain, kTolerance, nullptr, result.work);
  return result;
}

Blocks& wall(Blocks& blocks, const glm::u8vec4& colour) {
  return blocks.quad({kWall, -40, -40}, {0, 0, 80}, {0, 80, 0}, colour);
}

TEST(Supersample, AWallOfOneColourNeedsOneRay) {
  Blocks blocks;
  EXPECT_EQ(cast(wall(blocks, {150, 160, 170, 255}).build()).work.samples_refined, 0u);
}

TEST(Supersample, StripesFinerThanSamplesComeOutGrey) {
  // Each stripe is 0.45 samples wide: one ray sees black or white, and from column to column mostly the other.
  Blocks blocks;
  const auto width = static_cast<float>(0.45 * kSpacing);
  for (int k = 0; k * width < 3.0f; ++k) {
    const std::uint8_t level = k % 2 ? 30 : 220;
    blocks.quad({kWall, -4 + static_cast<float>(k) * width, -40}, {0, 0, 80}, {0, width, 0}, {level, level, level, 255});
  }
  const Colours colours = cast(blocks.build());
  const float light = vertex_light({1, 0, 0});
  const float low = light * srgb_to_linear(30), high = light * srgb_to_linear(220), mean = 0.5f * (low + high);
  double one_ray = 0, several = 0;
  for (int j = 40; j < 60; ++j)
    for (int i = 40; i < 90; ++i) {
      const float shown = srgb_to_linear(static_cast<std::uint8_t>(colours.level(i, j)));
      several += (shown - mean) * (shown - mean);
      one_ray += (high - mean) * (high - mean);  // whichever it sees
    }
  EXPECT_LT(std::sqrt(several), 0.5 * std::sqrt(one_ray));
  EXPECT_GE(colours.work.samples_refined, 20u * 50u);
}

TEST(Supersample, AWireThinnerThanASampleIsSeenInNearlyEveryRow) {
  // Slanted by a third of a sample from row to row and 0.3 samples wide: rows where no sample's centre meets it are between
  // rows where one does.
  Blocks blocks;
  wall(blocks, {230, 230, 230, 255});
  const auto step = static_cast<float>(kSpacing * 0.8);  // the wire hangs at four fifths of the wall's distance
  const glm::vec3 along(0, 100 * step / 3, 100 * step);
  blocks.quad({static_cast<float>(kWall * 0.8), -3.0f, -3.5f}, along, {0, 0.3f * step, 0}, {10, 10, 10, 255});
  const Colours colours = cast(blocks.build());
  const int background = colours.level(120, 120);
  int rows = 0, darkened = 0, hit = 0;
  for (int j = 20; j < 80; ++j) {
    int darkest = 255;
    for (int i = 0; i < kTileSamples; ++i) darkest = std::min(darkest, colours.level(i, j));
    ++rows, darkened += darkest < background - 15, hit += darkest < 60;
  }
  EXPECT_LT(hit, rows * 2 / 3) << "or the scene does not test what it should";
  EXPECT_GE(darkened, rows * 9 / 10) << "rays half a sample apart miss a wire of 0.3 here and there";
}

}  // namespace
}  // namespace farfield

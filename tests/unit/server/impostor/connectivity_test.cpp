// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/connectivity.h"

#include <gtest/gtest.h>

#include <random>

#include "server/impostor/dense_tile.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::Blocks;
using test::PlacedScene;

constexpr float kPitch = 0.002f, kWarpGain = 0.98f;
const ConnectionLimits kLimits = connection_limits(ViewFrame{{}, 1002, {}, 1.0, kPitch}, kWarpGain);

TEST(Connectivity, AFlatFloorIsOneSurfaceAtAnyAngle) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> slope(-0.05f, 0.05f), start(0.0f, 0.4f);
  for (int k = 0; k < 1000; ++k) {
    const float a = start(random), gradient = slope(random);
    EXPECT_TRUE(is_connected(a, gradient, a + gradient, gradient, kLimits, kPitch));
  }
  // Seen at a grazing angle: from one sample to the next the distance changes by half.
  EXPECT_TRUE(is_connected(0.02f, 0.02f, 0.04f, 0.02f, kLimits, kPitch));
}

TEST(Connectivity, AStepInDepthIsCut) {
  EXPECT_FALSE(is_connected(0.4f, 0.0f, 0.1f, 0.0f, kLimits, kPitch));
  EXPECT_FALSE(is_connected(0.1f, 0.0f, 0.4f, 0.0f, kLimits, kPitch));
  EXPECT_FALSE(is_connected(0.4f, 0.001f, 0.1f, -0.001f, kLimits, kPitch));
}

TEST(Connectivity, PlanesThatMeetBetweenTwoSamplesAreACrease) {
  // Both planes reach 0.21 half-way: a ridge; and 0.19: a groove.
  EXPECT_TRUE(is_connected(0.2f, 0.02f, 0.2f, -0.02f, kLimits, kPitch));
  EXPECT_TRUE(is_connected(0.2f, -0.02f, 0.2f, 0.02f, kLimits, kPitch));
  // The same slopes, but the planes meet only beyond the second sample.
  EXPECT_FALSE(is_connected(0.2f, 0.01f, 0.25f, 0.02f, kLimits, kPitch));
}

TEST(Connectivity, WhatMovesLessThanASampleIsConnected) {
  const float small = 0.9f * kLimits.one_sample;
  EXPECT_TRUE(is_connected(0.2f, 0.0f, 0.2f + small, 0.0f, kLimits, kPitch));
  EXPECT_FALSE(is_connected(0.02f, 0.0f, 0.02f + 3 * kLimits.one_sample, 0.0f, kLimits, kPitch));
}

TEST(Connectivity, ConnectionDoesNotDependOnTheOrderOfItsEnds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> slope(-0.01f, 0.01f), value(0.0f, 0.4f);
  int connected = 0;
  for (int k = 0; k < 2000; ++k) {
    const float a = value(random), b = k % 2 ? a + 0.02f * slope(random) : value(random), ga = slope(random), gb = slope(random);
    const bool forward = is_connected(a, ga, b, gb, kLimits, kPitch);
    EXPECT_EQ(forward, is_connected(b, -gb, a, -ga, kLimits, kPitch));
    connected += forward;
  }
  EXPECT_GT(connected, 0);
  EXPECT_LT(connected, 2000);
}

// A box before a wall, both facing +X: along any row and column the box's silhouette is known exactly.
TEST(Connectivity, CutsLieWithinAnEighthOfASampleOfTheEdge) {
  const double front = 3.25;
  const Box box{{front, -0.8125, -0.6875}, {3.5, 0.71875, 0.65625}};
  const PlacedScene placed = Blocks().quad({6, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 150, 150, 255}).box(box).build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const int edge = face_samples(3);
  TileWork work;
  const Tile tile = cast_dense_tile(*placed.scene, space, placed.at(glm::dvec3(0)), {{}, kIntraView, 0, 1, 1}, edge, kWarpGain, 1e-4, nullptr, work);
  const auto index = [&](int i, int j) { return static_cast<std::size_t>(j - kTileStride) * kTileSamples + static_cast<std::size_t>(i - kTileStride); };
  int checked = 0;
  const auto check = [&](bool is_down, double silhouette, double low, double high) {
    const double crossing = sample_index(edge, silhouette / front);
    const int first = static_cast<int>(std::floor(crossing));
    const int begin = static_cast<int>(sample_index(edge, low / front)) + 2, end = static_cast<int>(sample_index(edge, high / front)) - 1;
    for (int along = begin; along < end; ++along) {
      const std::size_t at = is_down ? index(along, first) : index(first, along);
      const std::uint8_t cut = (is_down ? tile.cut_down : tile.cut_right)[at];
      ASSERT_NE(cut, kConnected);
      // Bisection answers in eighths; the cut stands for the middle of its eighth.
      ASSERT_NEAR((cut - 0.5) / 8, crossing - first, 1.0 / 16 + 1e-3) << (is_down ? "down" : "right") << " at " << along;
      ++checked;
    }
  };
  // Face +X: u runs along y, v along z.
  check(false, box.min.y, box.min.z, box.max.z);
  check(false, box.max.y, box.min.z, box.max.z);
  check(true, box.min.z, box.min.y, box.max.y);
  check(true, box.max.z, box.min.y, box.max.y);
  EXPECT_GT(checked, 100);
  // And nowhere else: cuts right stand only on the two vertical silhouettes.
  std::size_t cuts_right = 0;
  for (const std::uint8_t cut : tile.cut_right) cuts_right += cut != kConnected;
  const double rows = (box.max.z - box.min.z) / front / sample_pitch(edge);
  EXPECT_NEAR(static_cast<double>(cuts_right), 2 * rows, 6);
}

// Connections down the column through the middle of a sill's front, over its edge and up the wall behind it, that are cut. The
// eye looks from `height` above the sill's top, which is less than half a sample high there.
int cuts_across_a_sill(double front, double wall, double height, bool has_top) {
  Blocks blocks;
  blocks.quad({wall, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 150, 150, 255});
  blocks.quad({front, -1, -1}, {0, 0, 1 - height}, {0, 2, 0}, {90, 90, 90, 255});
  if (has_top) blocks.quad({front, -1, -height}, {wall - front, 0, 0}, {0, 2, 0}, {90, 90, 90, 255});
  const PlacedScene placed = blocks.build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  TileWork work;
  const Tile tile = cast_dense_tile(*placed.scene, space, placed.at(glm::dvec3(0)), {{}, kIntraView, 0, 1, 1}, face_samples(3), kWarpGain, 1e-4, nullptr, work);
  int cuts = 0;
  // Face +X: v, and so the rows, along z: from below the edge to above it.
  const int middle = kTileSamples / 2, edge = static_cast<int>(sample_index(face_samples(3), -height / front)) - kTileStride;
  for (int row = edge - 3; row <= edge + 3; ++row) cuts += tile.cut_down[static_cast<std::size_t>(row) * kTileSamples + middle] != kConnected;
  return cuts;
}

TEST(Connectivity, ASillTooThinForASampleIsBridged) {
  EXPECT_EQ(cuts_across_a_sill(3.2, 3.3, 0.2, true), 0);
  EXPECT_EQ(cuts_across_a_sill(3.2, 3.3, 0.2, false), 1) << "nothing there: seen from above, a gap";
  EXPECT_EQ(cuts_across_a_sill(3.2, 3.6, 0.05, true), 1) << "so deep that it opens to more than four samples";
}

// A ceiling that runs through the whole shell: where it comes in and where it leaves is known exactly.
TEST(Connectivity, SurfacesGoOnBeyondTheBordersOfTheShell) {
  const double height = 0.7;  // within this tile at both borders
  const PlacedScene placed = Blocks().quad({-40, height, -40}, {80, 0, 0}, {0, 0, 80}, {150, 150, 150, 255}).build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0, false);
  const int edge = face_samples(3);
  TileWork work;
  const Tile tile = cast_dense_tile(*placed.scene, space, placed.at(glm::dvec3(0)), {{}, kIntraView, 0, 1, 1}, edge, kWarpGain, 1e-4, nullptr, work);
  // Face +X: u runs along y, so that the ceiling is seen at u = height / x.
  const auto check = [&](double x, bool is_covered_before) {
    const double crossing = sample_index(edge, height / x) - kTileStride;
    const int first = static_cast<int>(std::floor(crossing));
    int checked = 0;
    for (int row = 40; row < 80; ++row) {
      const std::size_t at = static_cast<std::size_t>(row) * kTileSamples + static_cast<std::size_t>(first);
      ASSERT_EQ(tile.coverage[at] != 0, is_covered_before);
      ASSERT_NE(tile.cut_right[at], kConnected);
      const double place = (tile.cut_right[at] - 0.5) / 8, exact = crossing - first;
      const double beyond = is_covered_before ? place - exact : exact - place;
      if (tile.cut_right[at] > 1 && tile.cut_right[at] < 8) {
        ASSERT_NEAR(beyond, 2.0 / 8, 1.0 / 16 + 1e-3);
      }
      ASSERT_GE(beyond, -1.0 / 16 - 1e-3);
      ++checked;
    }
    EXPECT_EQ(checked, 40);
  };
  check(2.5, true);   // the near region's side: farther away is more to the left
  check(5.0, false);  // the parent's
}

}  // namespace
}  // namespace farfield

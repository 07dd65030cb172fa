// SPDX-License-Identifier: Apache-2.0
// Delta tiles against analytic visibility: a room, a pillar, and slab tests instead of rays.
#include "server/impostor/delta_tile.h"

#include <gtest/gtest.h>

#include <set>

#include "server/impostor/void_finder.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::PlacedScene;

ImpostorSettings settings_of_three_delta_tiles() {
  ImpostorSettings settings;
  settings.face_tiles = 4;
  return settings;
}
const ImpostorSettings kSettings = settings_of_three_delta_tiles();
const int kEdge = kSettings.edge_samples(1);
constexpr double kTolerance = 1e-3, kWarpGain = 2.0;
const Box kRoom{{-4, -4, -4}, {4, 4, 4}};

// Whether the segment passes through the box (slab test).
bool is_blocked(const glm::dvec3& from, const glm::dvec3& to, const Box& box) {
  double enter = 0, leave = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double step = to[axis] - from[axis];
    const double a = (box.min[axis] - from[axis]) / step, b = (box.max[axis] - from[axis]) / step;
    enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
  }
  return enter < leave;
}

class PillarRoom : public testing::Test {
 protected:
  PillarRoom() : placed_(test::pillar_room().build()), space_(test::space_around(placed_, {0, 0, 0}, 1.0)) {}

  Tile cast(const TileId& id) {
    TileWork work;
    return cast_delta_tile(*placed_.scene, space_, {placed_.at(glm::dvec3(0)), placed_.at(second_)}, id, kSettings, kWarpGain, kTolerance, nullptr, work, skips_);
  }
  // World point that the second view sees through a sample, straight from the room's shape.
  glm::dvec3 wall_point(int face, int i, int j, bool& is_wall) const {
    const glm::dvec3 direction = CubeFace::of(face).direction(sample_tangent(kEdge, i), sample_tangent(kEdge, j));
    const glm::dvec3 point = second_ + direction * exit_distance(kRoom, second_, direction);
    is_wall = !is_blocked(second_, point, kPillarOnlyInside);
    return point;
  }

  // Seen from outside only between floor and ceiling, which it reaches: cut a little, so that both planes differ.
  static constexpr double kOver = 1.0;
  const Box kPillarOnlyInside{test::kPillar.min - glm::dvec3(0, kOver, 0), test::kPillar.max + glm::dvec3(0, kOver, 0)};
  const glm::dvec3 second_{0.4375, 0.125, 0.5};
  const PlacedScene placed_;
  const CellSpace space_;
  DeltaSkips skips_;
};

TEST_F(PillarRoom, TheDeltaViewHoldsTheWallBehindThePillarAndNothingThatTheFirstViewSees) {
  std::size_t hidden = 0, missing = 0, kept = 0, superfluous = 0;
  const Box thinner{kPillarOnlyInside.min + glm::dvec3(0.03), kPillarOnlyInside.max - glm::dvec3(0.03)};
  const int regions = face_regions(kEdge);
  for (int face = 0; face < kCubeFaces; ++face) {
    std::set<std::pair<int, int>> covered;
    for (int y = 0; y < regions; ++y)
      for (int x = 0; x < regions; ++x) {
        const Tile tile = cast({{}, 1, static_cast<std::uint8_t>(face), static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)});
        for (std::size_t b = 0; b < tile.blocks.size(); ++b)
          for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
            const int column = static_cast<int>(b) % kPackedColumns * kBlockSamples + k % kBlockSamples;
            const int row = static_cast<int>(b) / kPackedColumns * kBlockSamples + k / kBlockSamples;
            const int i = tile.blocks[b].x * kBlockSamples + k % kBlockSamples, j = tile.blocks[b].y * kBlockSamples + k / kBlockSamples;
            if (tile.coverage[static_cast<std::size_t>(row) * tile.width + column]) covered.emplace(i, j);
          }
      }
    const auto is_hidden = [&](int i, int j, const Box& pillar) {
      bool is_wall = false;
      const glm::dvec3 point = wall_point(face, i, j, is_wall);
      return is_wall && is_blocked(glm::dvec3(0), point, pillar);
    };
    for (int j = 0; j < kEdge; ++j)
      for (int i = 0; i < kEdge; ++i) {
        bool is_wall = false;
        wall_point(face, i, j, is_wall);
        if (!is_wall) continue;  // the pillar's own sides may be held again where the first view sees them obliquely
        const bool is_kept = covered.contains({i, j});
        const bool is_needed = is_hidden(i, j, thinner);
        hidden += is_needed, missing += is_needed && !is_kept;
        bool is_beside = false;  // the border of one sample, and half a sample for rounding
        for (int dj = -2; dj <= 2; ++dj)
          for (int di = -2; di <= 2; ++di) is_beside = is_beside || is_hidden(i + di, j + dj, kPillarOnlyInside);
        // Next to the pillar the border goes on from its own samples.
        for (int dj = -2; dj <= 2; ++dj)
          for (int di = -2; di <= 2; ++di) {
            bool is_wall_there = true;
            wall_point(face, i + di, j + dj, is_wall_there);
            is_beside = is_beside || !is_wall_there;
          }
        kept += is_kept, superfluous += is_kept && !is_beside;
      }
  }
  EXPECT_GT(hidden, 1000u);
  // A probe ray or three for each patch: a sliver at a patch's rim may be missed, no more.
  EXPECT_LE(missing, hidden / 200) << "of " << hidden;
  EXPECT_EQ(superfluous, 0u) << "of " << kept;
  EXPECT_GT(skips_.blocks_probed, skips_.blocks_cast);
}

TEST_F(PillarRoom, SamplesHaveTheDisparityOfTheWall) {
  std::size_t checked = 0;
  for (int x = 0; x < face_regions(kEdge); ++x) {
    const Tile tile = cast({{}, 1, 0, static_cast<std::uint8_t>(x), 1});
    if (tile.blocks.empty()) continue;
    ASSERT_EQ(tile.coverage.size(), tile.samples());
    for (std::size_t b = 0; b < tile.blocks.size(); ++b) {
      const std::size_t at = (b / kPackedColumns * kBlockSamples + 3) * tile.width + b % kPackedColumns * kBlockSamples + 3;
      if (!tile.coverage[at]) continue;
      bool is_wall = false;
      const glm::dvec3 point = wall_point(0, tile.blocks[b].x * kBlockSamples + 3, tile.blocks[b].y * kBlockSamples + 3, is_wall);
      if (!is_wall) continue;
      EXPECT_NEAR(tile.disparity[at], 1.0 / (point.x - second_.x), 1e-5);
      ++checked;
    }
  }
  EXPECT_GT(checked, 10u);
}

TEST_F(PillarRoom, WhatNobodySeesIsNeitherProbedNorCast) {
  const VisibleBlocks nothing({}, placed_.at(second_), kEdge);
  TileWork work;
  const Tile tile = cast_delta_tile(*placed_.scene, space_, {placed_.at(glm::dvec3(0)), placed_.at(second_)}, {{}, 1, 0, 1, 1}, kSettings, kWarpGain,
                                    kTolerance, &nothing, work, skips_);
  EXPECT_TRUE(tile.blocks.empty());
  EXPECT_EQ(work.rays, 0u);
}

// Plates close before a wall: beside each, the second view sees a strip of the wall a sample and a half wide.
TEST(DeltaTile, NarrowStripsBesideRimsAreFound) {
  constexpr double kPlate = 3.73, kSize = 0.15;
  const glm::dvec3 second(0, 0.4375, 0);
  test::Blocks blocks = test::plain_room();
  std::vector<glm::dvec2> corners;
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 12; ++column) {
      corners.emplace_back(-2.2 + 0.371 * column, -2.2 + 0.373 * row);
      blocks.quad({kPlate, corners.back().x, corners.back().y}, {0, 0, kSize}, {0, kSize, 0}, {90, 90, 90, 255});
    }
  const PlacedScene placed = blocks.build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  std::set<std::pair<int, int>> covered;
  for (int y = 0; y < face_regions(kEdge); ++y)
    for (int x = 0; x < face_regions(kEdge); ++x) {
      TileWork work;
      DeltaSkips skips;
      const TileId id{{}, 1, 0, static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)};
      const Tile tile = cast_delta_tile(*placed.scene, space, {placed.at(glm::dvec3(0)), placed.at(second)}, id, kSettings, kWarpGain, kTolerance, nullptr, work, skips);
      for (std::size_t b = 0; b < tile.blocks.size(); ++b) covered.emplace(tile.blocks[b].x, tile.blocks[b].y);
    }
  std::size_t found = 0;
  for (const glm::dvec2& corner : corners) {
    // The wall just beyond the plate's edge on the second view's side, as that view sees it, half-way up.
    const int i = static_cast<int>(sample_index(kEdge, (corner.x + kSize - second.y) / kPlate) + 1);
    const int j = static_cast<int>(sample_index(kEdge, (corner.y + kSize / 2) / kPlate));
    found += covered.contains({i / kBlockSamples, j / kBlockSamples}) || covered.contains({(i + 1) / kBlockSamples, j / kBlockSamples});
  }
  EXPECT_GE(found, corners.size() * 5 / 6) << "of " << corners.size();
}

// A slanted plate before a wall: the border of what it hides has steps, whose corners would stay open.
TEST(DeltaTile, TheBorderTurnsCorners) {
  constexpr double kPlate = 3;
  const glm::dvec2 corner(-0.5, -0.5), along(0.8, 0.3), across(-0.3, 0.8);
  const glm::dvec3 second(0, 0.4375, 0);
  const PlacedScene placed = test::plain_room().quad({kPlate, corner.x, corner.y}, {0, along.x, along.y}, {0, across.x, across.y}, {90, 90, 90, 255}).build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  const auto is_hidden_from = [&](const glm::dvec3& eye, const glm::dvec3& point) {
    const glm::dvec3 met = eye + (point - eye) * ((kPlate - eye.x) / (point.x - eye.x));
    const glm::dvec2 on = glm::inverse(glm::dmat2(along, across)) * (glm::dvec2(met.y, met.z) - corner);
    return on.x > 0 && on.x < 1 && on.y > 0 && on.y < 1;
  };
  const auto is_needed = [&](int i, int j) {
    const glm::dvec3 direction = CubeFace::of(0).direction(sample_tangent(kEdge, i), sample_tangent(kEdge, j));
    const glm::dvec3 point = second + direction * exit_distance(kRoom, second, direction);
    return !is_hidden_from(second, point) && is_hidden_from(glm::dvec3(0), point);
  };
  std::size_t corners = 0, open = 0;
  for (int y = 0; y < face_regions(kEdge); ++y)
    for (int x = 0; x < face_regions(kEdge); ++x) {
      TileWork work;
      DeltaSkips skips;
      const TileId id{{}, 1, 0, static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)};
      const Tile tile = cast_delta_tile(*placed.scene, space, {placed.at(glm::dvec3(0)), placed.at(second)}, id, kSettings, kWarpGain, kTolerance, nullptr, work, skips);
      for (std::size_t b = 0; b < tile.blocks.size(); ++b)
        for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
          const int i = tile.blocks[b].x * kBlockSamples + k % kBlockSamples, j = tile.blocks[b].y * kBlockSamples + k / kBlockSamples;
          bool is_corner = false;  // met by a needed sample of its patch, and by no needed one along an edge
          for (const glm::ivec2 step : {glm::ivec2(1, 1), glm::ivec2(-1, 1), glm::ivec2(1, -1), glm::ivec2(-1, -1)}) {
            const glm::ivec2 other = glm::ivec2(i, j) + step;
            is_corner |= other.x / kPatchSamples == i / kPatchSamples && other.y / kPatchSamples == j / kPatchSamples && is_needed(other.x, other.y);
          }
          if (!is_corner || is_needed(i, j) || is_needed(i + 1, j) || is_needed(i - 1, j) || is_needed(i, j + 1) || is_needed(i, j - 1)) continue;
          ++corners;
          open += !tile.coverage[(b / kPackedColumns * kBlockSamples + static_cast<std::size_t>(k / kBlockSamples)) * tile.width + b % kPackedColumns * kBlockSamples + k % kBlockSamples];
        }
    }
  EXPECT_GT(corners, 20u);
  EXPECT_LE(open, corners / 10) << "of " << corners;
}

TEST(DeltaTile, OfAConvexRoomHoldsNothing) {
  const PlacedScene placed = test::plain_room().build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  DeltaSkips skips;
  for (int face = 0; face < kCubeFaces; ++face) {
    TileWork work;
    const Tile tile = cast_delta_tile(*placed.scene, space, {placed.at(glm::dvec3(0)), placed.at(glm::dvec3(0.5, -0.5, 0.5))},
                                      {{}, 1, static_cast<std::uint8_t>(face), 1, 1}, kSettings, kWarpGain, kTolerance, nullptr, work, skips);
    EXPECT_TRUE(tile.blocks.empty()) << "face " << face;
  }
  EXPECT_EQ(skips.blocks_cast, 0u);
}

}  // namespace
}  // namespace farfield

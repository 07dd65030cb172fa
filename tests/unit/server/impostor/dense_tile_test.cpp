// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/dense_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

using test::Blocks;
using test::PlacedScene;

constexpr double kWarpGain = 0.98, kTolerance = 1e-4;
const int kEdge = face_samples(2);

std::size_t covered(const Tile& tile) { return static_cast<std::size_t>(std::count(tile.coverage.begin(), tile.coverage.end(), 1)); }

TEST(DenseTile, AWallCoversEverySampleAtItsExactDisparityWithoutCuts) {
  // Leaning away: x = 5 + y/4, far larger than what a face can see of it.
  const PlacedScene placed = Blocks().quad({-5, -40, -40}, {0, 0, 80}, {20, 80, 0}, {150, 160, 170, 255}).build();
  for (const double side : {0.5, 1.0}) {
    const CellSpace space = test::space_around(placed, {0, 0, 0}, side);
    const glm::dvec3 view(0.125 * side, -0.25 * side, 0.5 * side);
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) {
        TileWork work;
        const TileId id{{}, kIntraView, 0, static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)};
        const Tile tile = cast_dense_tile(*placed.scene, space, placed.at(view), id, kEdge, kWarpGain, kTolerance, nullptr, work);
        ASSERT_EQ(covered(tile), tile.samples());
        EXPECT_EQ(work.rays, tile.samples());
        EXPECT_EQ(std::count(tile.cut_right.begin(), tile.cut_right.end(), kConnected), static_cast<std::ptrdiff_t>(tile.samples()));
        EXPECT_EQ(std::count(tile.cut_down.begin(), tile.cut_down.end(), kConnected), static_cast<std::ptrdiff_t>(tile.samples()));
        for (int j = 0; j < kTileSamples; ++j)
          for (int i = 0; i < kTileSamples; ++i) {
            // The plane x - y/4 = 5 from the view: (1 - u/4)·z = 5 - view.x + view.y/4, u along y.
            const double u = sample_tangent(kEdge, id.x * kTileStride + i);
            const double exact = side * (1 - u / 4) / (5 - view.x + view.y / 4);
            ASSERT_NEAR(tile.disparity[static_cast<std::size_t>(j) * kTileSamples + i], exact, 1e-5);
          }
        EXPECT_NEAR(tile.view_offset.z, 0.5, 1e-6);
      }
  }
}

TEST(DenseTile, DirectionsWithoutSurfaceAreCoveredNowhere) {
  const PlacedScene placed = Blocks().quad({5, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 160, 170, 255}).build();
  TileWork work;
  const Tile tile = cast_dense_tile(*placed.scene, test::space_around(placed, {0, 0, 0}, 1.0), placed.at(glm::dvec3(0)),
                                    {{}, kIntraView, 1, 0, 0}, kEdge, kWarpGain, kTolerance, nullptr, work);
  EXPECT_EQ(covered(tile), 0u);
}

TEST(DenseTile, OnlyTheShellIsSeen) {
  // A near wall with a hole in the middle would hide what lies behind it, were it not inside the near region.
  Blocks blocks;
  blocks.box({{1.0, -1.5, -1.5}, {1.25, 1.5, 1.5}});
  blocks.quad({3.5, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 160, 170, 255});
  blocks.quad({9, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 160, 170, 255});
  const PlacedScene placed = blocks.build();
  const auto first_sample = [&](const CellSpace& space) {
    TileWork work;
    const Tile tile = cast_dense_tile(*placed.scene, space, placed.at(glm::dvec3(0)), {{}, kIntraView, 0, 0, 0}, kEdge, kWarpGain, kTolerance, nullptr, work);
    return tile.coverage.back() ? 1.0 / tile.disparity.back() : 0.0;
  };
  CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0, false);
  EXPECT_NEAR(first_sample(space), 3.5, 1e-4) << "past the near box, up to the wall inside the shell";
  space.shell.inside = space.box.grown(3.25);
  EXPECT_NEAR(first_sample(space), 0.0, 1e-9) << "the far wall lies beyond the parent's near region";
  space.shell.outside = RayClip{}.outside;
  EXPECT_NEAR(first_sample(space), 9.0, 1e-4) << "a root's shell reaches to infinity";
}

TEST(DenseTile, SamplesThatNobodySeesAreNotCast) {
  const PlacedScene placed = Blocks().quad({5, -40, -40}, {0, 0, 80}, {0, 80, 0}, {150, 160, 170, 255}).build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 1.0);
  BoxVisibility seen;
  seen.far_hits.push_back({glm::vec3(placed.at(glm::dvec3(5, -2, -2))), 1e-3f});
  const glm::dvec3 view = placed.at(glm::dvec3(0));
  const VisibleBlocks visible(points_in_shell(seen, space), view, kEdge);
  TileWork work;
  const Tile tile = cast_dense_tile(*placed.scene, space, view, {{}, kIntraView, 0, 0, 0}, kEdge, kWarpGain, kTolerance, &visible, work);
  std::size_t wanted = 0;
  for (int j = 0; j < kTileSamples; ++j)
    for (int i = 0; i < kTileSamples; ++i) {
      const bool is_visible = visible.contains(0, i, j);
      wanted += is_visible;
      ASSERT_EQ(tile.coverage[static_cast<std::size_t>(j) * kTileSamples + i], is_visible);
    }
  EXPECT_EQ(work.rays, wanted);
  EXPECT_GT(wanted, 0u);
  EXPECT_LT(wanted, tile.samples() / 4);
}

TEST(ViewFrame, PlanesAgreeWithFiniteDifferences) {
  // Four large triangles around the viewpoint, none of them along an axis.
  const glm::vec3 a(9, 7, 8), b(-8, -9, 7), c(-7, 8, -9), d(8, -7, -8);
  const PlacedScene placed = Blocks().triangle(a, b, c).triangle(a, c, d).triangle(a, d, b).triangle(b, d, c).build();
  const CellSpace space = test::space_around(placed, {0, 0, 0}, 0.5);
  const glm::dvec3 view = placed.at(glm::dvec3(0.125, -0.125, 0.0625));
  std::mt19937 random(3);
  int checked = 0;
  for (int k = 0; k < 600; ++k) {
    const ViewFrame frame = ViewFrame::of(space, view, k % kCubeFaces, 200);
    const int i = static_cast<int>(random() % 199), j = static_cast<int>(random() % 199);
    RayPacket rays;
    HitPacket hits;
    rays.active = 7;
    for (int lane = 0; lane < kPacketSize; ++lane) set_ray(rays, lane, view, frame.direction(i + (lane == 1), j + (lane == 2)), space.shell);
    placed.scene->intersect(rays, hits);
    ASSERT_NE(hits.part[0], kNoHit);
    const SurfacePlane plane = plane_at(frame, rays, hits, 0);
    for (int lane = 1; lane <= 2; ++lane) {
      if (hits.primitive[lane] != hits.primitive[0]) continue;
      const double difference = frame.side_m / hits.distance[lane] - frame.side_m / hits.distance[0];
      EXPECT_NEAR(lane == 1 ? plane.gradient_i : plane.gradient_j, difference, 2e-6) << "face " << k % kCubeFaces;
      ++checked;
    }
  }
  EXPECT_GT(checked, 1000);
}

}  // namespace
}  // namespace farfield

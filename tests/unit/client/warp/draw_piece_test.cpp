// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "client/warp/cpu_warper.h"
#include "client/warp/piece_on_screen.h"
#include "client/warp/splat_key.h"
#include "tests/unit/client/warp/warp_scene.h"

namespace farfield::client {
namespace {

constexpr int kEdge = face_samples(1);

/// A whole face of the plane normal·x = -1 (metres), seen from the origin.
Tile plane_of(const glm::dvec3& normal) {
  Tile tile;
  tile.edge_samples = kEdge;
  tile.id.face = kMinusZ;
  tile.width = tile.height = kEdge;
  tile.disparity_tolerance = 1e-3f;
  tile.coverage.assign(tile.samples(), 1);
  tile.cut_right.assign(tile.samples(), 0), tile.cut_down.assign(tile.samples(), 0);
  std::mt19937 random(4);
  for (int j = 0; j < kEdge; ++j) {
    for (int i = 0; i < kEdge; ++i) {
      const double u = sample_tangent(kEdge, i), v = sample_tangent(kEdge, j);
      tile.disparity.push_back(static_cast<float>(normal.z - normal.x * u - normal.y * v));
      for (int c = 0; c < 3; ++c) tile.rgb.push_back(static_cast<std::uint8_t>(random()));
    }
  }
  return tile;
}

std::shared_ptr<DecodedTile> decoded(const Tile& tile) {
  auto result = std::make_shared<DecodedTile>();
  result->id = tile.id;
  result->splats = build_splats(tile, true);
  return result;
}

TEST(DrawPiece, WarpingAViewOntoItselfGivesItself) {
  const Tile tile = plane_of({0.02, -0.01, 0.3});
  const auto shown = decoded(tile);
  ASSERT_EQ(shown->splats.pieces.samples, tile.samples());
  Frame frame;
  CpuWarper().draw(leaf_of({shown}), Pose{}, display_on_samples(kEdge, kEdge, 100), nullptr, frame);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < kEdge; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * kEdge + static_cast<std::size_t>(x);
      const auto sample = static_cast<std::size_t>((kEdge / 2 + 49 - y) * kEdge + x);  // v goes up, rows go down
      for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(frame.rgba[4 * pixel + c], tile.rgb[3 * sample + c]) << x << " " << y;
      ASSERT_EQ(frame.coverage[pixel], Coverage::kImpostor);
      ASSERT_NEAR(frame.disparity[pixel], tile.disparity[sample], 1e-6f);
    }
  }
}

// Every pixel that looks at the plane is covered, from anywhere in the cell, at 0.7 to 2 pixels per sample, and by the plane's
// own depth: kDistancePenalty and kFootprintPenalty take less than a four-hundredth off, rounding of floats a few 2⁻²⁰.
TEST(DrawPiece, AConnectedPlaneIsClosedAndWhereItIs) {
  for (const glm::dvec3& normal : {glm::dvec3(0, 0, 0.4), {0.5, 0, 0.25}, {0.1, -0.55, 0.3}, {-0.4, 0.4, 0.35}}) {
    const auto tile = decoded(plane_of(normal));
    for (int k = 0; k < 24; ++k) {
      const Display display = display_on_samples(kEdge * (2 + k % 4) / 3, 200, 160);
      const Pose eye{{k & 1 ? 0.5 : -0.5, k & 2 ? 0.5 : -0.5, k & 4 ? 0.5 : -0.5}, glm::angleAxis(0.4 * k, glm::dvec3(0, 0, 1))};
      Frame frame;
      CpuWarper().draw(leaf_of({tile}), eye, display, nullptr, frame);
      int inside = 0;
      for (int y = 0; y < display.height; ++y) {
        for (int x = 0; x < display.width; ++x) {
          const glm::dvec3 ray = eye.world_from_camera * camera_direction(display, x + 0.5, y + 0.5);
          const double along = -(1.0 + glm::dot(normal, eye.position)) / glm::dot(normal, ray);
          const glm::dvec3 point = eye.position + along * ray;
          if (!(along > 0 && point.z < 0) || std::max(std::abs(point.x), std::abs(point.y)) > -point.z) continue;
          ++inside;
          const std::size_t at = static_cast<std::size_t>(y) * display.width + x;
          ASSERT_EQ(frame.coverage[at], Coverage::kImpostor) << k << " " << x << " " << y;
          ASSERT_NEAR(frame.disparity[at], 1 / along, 2.5e-3 / along + 4e-6);
        }
      }
      EXPECT_GT(inside, 2000) << k;
    }
  }
}

/// Steps, slopes, cuts anywhere and samples missing.
Tile ragged(std::mt19937& random) {
  Tile tile = plane_of({0.1, 0.05, 0.3});
  for (std::size_t k = 0; k < tile.samples(); ++k) {
    const std::size_t i = k % kEdge, j = k / kEdge;
    tile.disparity[k] += 0.1f * static_cast<float>((i / 11 + j / 13) % 3) + 1e-4f * static_cast<float>(i % 11 * (j % 3));
    if (i % 11 == 10 && random() % 4) tile.cut_right[k] = static_cast<std::uint8_t>(1 + random() % 8);
    if (j % 13 == 12 && random() % 4) tile.cut_down[k] = static_cast<std::uint8_t>(1 + random() % 8);
    if (random() % 60 == 0) tile.coverage[k] = 0;
    if (random() % 20 == 0) tile.cut_right[k] = 8;
  }
  return tile;
}

TEST(DrawPiece, VectorAndScalarAreBitIdentical) {
  std::mt19937 random(7);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  Display display;
  display.width = 203, display.height = 150;
  const PixelWindow window{203, 11, 133};
  std::size_t drawn = 0, cut_short = 0, whole = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const auto tile = decoded(trial % 4 == 0 ? plane_of({0.3, 0.1, 0.3}) : ragged(random));
    display.fovy_rad = trial % 5 == 0 ? uniform(0.02, 0.2) : uniform(0.3, 2.9);
    const double away = trial % 3 == 0 ? 3.0 : 0.5;  // some eyes are behind surfaces, or in them
    const Pose eye{{uniform(-away, away), uniform(-away, away), uniform(-away, away)},
                   glm::angleAxis(uniform(-1, 1), glm::normalize(glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))))};
    const TileProjection projection =
        TileProjection::of(*tile, eye.position, pixels_from_directions(eye.world_from_camera, display));
    std::vector<std::uint64_t> vector(203 * 150, kNoSplat), scalar = vector;
    const SurfacePieces& pieces = tile->splats.pieces;
    for (std::size_t s = 0; s < pieces.squares.size(); ++s) {
      for (std::size_t p = pieces.squares[s].first_piece; p < pieces.piece_end(s); ++p) {
        PlacedPiece placed;
        if (!place_piece(projection, tile->splats, pieces.squares[s], pieces.pieces[p], window, placed)) continue;
        ASSERT_TRUE(placed.left >= 0 && placed.right < 203 && placed.top >= 11 && placed.bottom < 133);
        draw_piece(placed, 203, vector.data());
        draw_piece_scalar(placed, 203, scalar.data());
        ++drawn;
        whole += placed.reach == nullptr;
        cut_short += std::min(placed.farthest_u, placed.farthest_v) < kPositionSteps;
      }
    }
    ASSERT_EQ(vector, scalar) << trial;
  }
  EXPECT_GT(drawn, 5000u);
  EXPECT_GT(cut_short, 100u);
  EXPECT_GT(whole, 500u);
}

// A window's rows show what they show in the whole frame.
TEST(DrawPiece, BandsDoNotShow) {
  std::mt19937 random(8);
  const auto tile = decoded(ragged(random));
  const Pose eye{{0.3, -0.2, 0.1}, glm::angleAxis(0.5, glm::normalize(glm::dvec3(1, 2, 3)))};
  Display display;
  display.width = 160, display.height = 96;
  const TileProjection projection =
      TileProjection::of(*tile, eye.position, pixels_from_directions(eye.world_from_camera, display));
  const auto draw = [&](int rows) {
    std::vector<std::uint64_t> keys(160 * 96, kNoSplat);
    for (int top = 0; top < 96; top += rows) {
      const PixelWindow window{160, top, top + rows};
      const SurfacePieces& pieces = tile->splats.pieces;
      for (std::size_t s = 0; s < pieces.squares.size(); ++s) {
        for (std::size_t p = pieces.squares[s].first_piece; p < pieces.piece_end(s); ++p) {
          PlacedPiece placed;
          if (place_piece(projection, tile->splats, pieces.squares[s], pieces.pieces[p], window, placed)) draw_piece(placed, 160, keys.data());
        }
      }
    }
    return keys;
  };
  const auto whole = draw(96);
  EXPECT_GT(std::count_if(whole.begin(), whole.end(), [](auto key) { return key != kNoSplat; }), 3000);
  EXPECT_EQ(draw(3), whole);
}

}  // namespace
}  // namespace farfield::client

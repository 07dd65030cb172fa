// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/surface_pieces.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "common/impostor/splats.h"
#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

constexpr float kTolerance = 1e-3f;
/// An eighth, and what float rounding adds.
constexpr float kFarthestOff = kTolerance / 8 + 1e-7f;

Tile dense_tile(float (*disparity)(int i, int j)) {
  Tile tile;
  tile.id = {CellId{}, kIntraView, 2, 1, 1};  // of three by three: one row or column at every side belongs to another
  tile.edge_samples = face_samples(3);
  tile.width = tile.height = kTileSamples;
  tile.coverage.assign(tile.samples(), 1);
  tile.cut_right.assign(tile.samples(), 0), tile.cut_down.assign(tile.samples(), 0);
  for (int j = 0; j < kTileSamples; ++j) {
    for (int i = 0; i < kTileSamples; ++i) {
      tile.disparity.push_back(disparity(i, j));
      for (const int channel : {i, j, 7}) tile.rgb.push_back(static_cast<std::uint8_t>(channel));
    }
  }
  tile.disparity_tolerance = kTolerance;
  return tile;
}
float slope(int i, int j) { return 0.2f + 1e-3f * static_cast<float>(i) - 5e-4f * static_cast<float>(j); }
float bulge(int i, int j) { return 0.2f + 1e-4f * static_cast<float>(i * i) - 5e-4f * static_cast<float>(j); }

float plane_at(const SurfacePiece& piece, int i, int j) {
  return piece.disparity + static_cast<float>(i) * piece.slope_u + static_cast<float>(j) * piece.slope_v;
}

TEST(SurfacePieces, APlaneIsWholeSquares) {
  const Tile tile = dense_tile(slope);
  InPieces in_pieces;
  const SurfacePieces found = find_surface_pieces(tile, in_pieces);
  EXPECT_EQ(found.samples, 126u * 126u);
  ASSERT_EQ(found.squares.size(), 256u);
  EXPECT_EQ(found.pieces.size(), 256u);
  EXPECT_EQ(found.reach.size(), 31u * 64) << "only the last squares of rows and columns, of six samples, are not whole";
  const PieceSquare& square = found.squares[17];  // the second of the second row
  EXPECT_EQ(square.column, kTileStride + 9);
  EXPECT_EQ(square.row, kTileStride + 9);
  EXPECT_EQ(square.first_reach, SurfacePieces::kAllConnected);
  const SurfacePiece& piece = found.pieces[square.first_piece];
  EXPECT_NEAR(piece.disparity, slope(9, 9), 1e-6f);
  EXPECT_NEAR(piece.slope_u, 1e-3f, 1e-6f);
  EXPECT_NEAR(piece.slope_v, -5e-4f, 1e-6f);
  EXPECT_EQ(piece.own, ~std::uint64_t{0});
  EXPECT_EQ(found.texels[17 * kSquareTexelBytes], 8) << "the ring around it begins one sample before";
  EXPECT_EQ(found.texels[17 * kSquareTexelBytes + kSquareTexels + kRingEdge + 1], 9);
  EXPECT_EQ(in_pieces[0], 0);
  EXPECT_EQ(in_pieces[129], 1);
}

TEST(SurfacePieces, EndAtCuts) {
  Tile tile = dense_tile([](int i, int) { return i <= 12 ? 0.1f : 0.3f; });
  for (int j = 0; j < kTileSamples; ++j) tile.cut_right[128 * j + 12] = 3;
  InPieces in_pieces;
  const SurfacePieces found = find_surface_pieces(tile, in_pieces);
  const PieceSquare& square = found.squares[17];  // samples 9 to 16
  ASSERT_EQ(found.piece_end(17) - square.first_piece, 2u);
  const SurfacePiece &left = found.pieces[square.first_piece], &right = found.pieces[square.first_piece + 1];
  EXPECT_EQ(left.own, 0x0f0f0f0f0f0f0f0fu);
  EXPECT_EQ(right.own, 0xf0f0f0f0f0f0f0f0u);
  EXPECT_FLOAT_EQ(left.disparity, 0.1f);
  EXPECT_FLOAT_EQ(right.disparity, 0.3f);
  EXPECT_EQ(left.held[4], 0b0000011111u) << "with the sample before the square, of the same surface";
  EXPECT_EQ(right.held[4], 0b1111100000u);
  EXPECT_EQ(left.held[0], 0b0000011111u) << "and those above";
  ASSERT_NE(square.first_reach, SurfacePieces::kAllConnected);
  EXPECT_EQ(found.reach[square.first_reach + 3], pack_reach(10, kReachBehind, 10, 10)) << "the nearer one hides it";
  EXPECT_EQ(found.reach[square.first_reach + 4], pack_reach(11, 10, 10, 10));
  EXPECT_EQ(square.lowest, 0.1f);
  EXPECT_EQ(square.highest, 0.3f);
}

TEST(SurfacePieces, CurvedSurfacesAreDividedUntilTheyArePlane) {
  const Tile tile = dense_tile(bulge);
  InPieces in_pieces;
  const SurfacePieces found = find_surface_pieces(tile, in_pieces);
  EXPECT_GT(found.pieces.size(), 256u);
  EXPECT_EQ(found.samples, 126u * 126u);
  for (std::size_t s = 0; s < found.squares.size(); ++s) {
    const PieceSquare& square = found.squares[s];
    std::uint64_t all = 0;
    for (std::size_t p = square.first_piece; p < found.piece_end(s); ++p) {
      const SurfacePiece& piece = found.pieces[p];
      EXPECT_EQ(all & piece.own, 0u);
      all |= piece.own;
      for (int k = 0; k < 64; ++k) {
        if (!(piece.own >> k & 1)) continue;
        const int i = square.column - kTileStride + k % 8, j = square.row - kTileStride + k / 8;
        ASSERT_NEAR(plane_at(piece, k % 8, k / 8), bulge(i, j), kFarthestOff);
        ASSERT_TRUE(square.lowest <= bulge(i, j) + kFarthestOff && square.highest >= bulge(i, j) - kFarthestOff);
      }
      EXPECT_EQ(piece.held[4] & 0xfe, 0xfe) << "colours are blended across";
    }
  }
}

TEST(SurfacePieces, WithoutToleranceThereAreNone) {
  Tile tile = dense_tile(slope);
  tile.disparity_tolerance = 0;
  InPieces in_pieces;
  EXPECT_TRUE(find_surface_pieces(tile, in_pieces).squares.empty());
}

// Whatever is covered and cut: every sample is drawn once, as part of a piece near its plane or by itself.
TEST(SurfacePieces, EverySampleIsDrawnOnce) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    Tile tile = dense_tile(seed % 3 == 0 ? slope : bulge);
    if (seed % 2 == 1) {
      tile.id.view = 1, tile.id.x = tile.id.y = 0;
      for (std::uint16_t x = 0; x < 16; ++x)
        for (std::uint16_t y = 0; y < 16; ++y)
          if (random() % 3) tile.blocks.push_back({x, y});
      tile.width = packed_width(tile.blocks.size()), tile.height = packed_height(tile.blocks.size());
      ASSERT_TRUE(tile.is_packed());
      const std::size_t samples = tile.samples();
      tile.coverage.assign(samples, 0), tile.cut_right.assign(samples, 0), tile.cut_down.assign(samples, 0);
      tile.disparity.assign(samples, 0.2f), tile.rgb.assign(3 * samples, 9);
      for (std::size_t b = 0; b < tile.blocks.size(); ++b)
        for (std::size_t k = 0; k < 64; ++k)
          tile.coverage[(b / kPackedColumns * 8 + k / 8) * static_cast<std::size_t>(tile.width) + b % kPackedColumns * 8 + k % 8] = 1;
    }
    std::size_t covered = 0;
    for (std::size_t k = 0; k < tile.samples(); ++k) {
      if (random() % 20 == 0) tile.coverage[k] = 0;
      tile.cut_right[k] = random() % 8 ? 0 : 1 + random() % 8, tile.cut_down[k] = random() % 8 ? 0 : 1 + random() % 8;
      if (random() % 30 == 0) tile.disparity[k] += 0.1f;
      const int i = static_cast<int>(k) % tile.width, j = static_cast<int>(k) / tile.width;
      covered += tile.coverage[k] && (tile.is_packed() || (i > 0 && j > 0 && i < 127 && j < 127));
    }
    InPieces in_pieces;
    const SurfacePieces found = find_surface_pieces(tile, in_pieces);
    const Splats splats = build_splats(tile, true);
    std::size_t in_runs = 0, owned = 0, marked = 0;
    for (const SplatRun& run : splats.runs) in_runs += run.count;
    for (const SurfacePiece& piece : found.pieces) owned += static_cast<std::size_t>(std::popcount(piece.own));
    for (const std::uint8_t is_in : in_pieces) marked += is_in;
    EXPECT_EQ(owned, found.samples);
  EXPECT_EQ(marked, found.samples);
  EXPECT_EQ(splats.pieces.samples, found.samples);
    EXPECT_EQ(in_runs + owned, covered) << seed;
    EXPECT_EQ(splats.drawn, covered);
    EXPECT_GT(in_runs, 100u);
  EXPECT_GT(owned, 1000u);
    EXPECT_LT(splats.size(), covered) << "of those in pieces only the neighbours of others are held";
  }
}

}  // namespace
}  // namespace farfield

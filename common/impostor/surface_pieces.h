// SPDX-License-Identifier: Apache-2.0
// The parts of a tile's surfaces that are plane in disparity, in squares of 8×8 samples: nearly all that a tile holds. A
// renderer draws such a piece pixel by pixel from one linear map, as a small textured polygon, and needs no disparity per
// sample.
//
// Of a square with a wall (w) and a pipe before it, `own` of the wall's piece has 11100111 in each row. Where a surface is
// not plane, as a pipe close by, it is several pieces: `held` says of them all which samples are one surface, so that colours
// are blended across.
//
// Based on: Wilson & Manocha 2003, section 4.2 (planes of the scene are planes in (x, y, 1/z)). Differs: no mesh; where
// pieces end is said sample by sample, as for splats.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/impostor/tile.h"

namespace farfield {

/// Whether this machine draws pieces faster than the same samples one by one: with vectors that can look tables up.
#if defined(__AVX512BW__) && defined(__AVX512VBMI__)
inline constexpr bool kPiecesAreFaster = true;
#else
inline constexpr bool kPiecesAreFaster = false;
#endif

inline constexpr int kSquareEdge = 8;                 // samples
inline constexpr int kSquareSamples = kSquareEdge * kSquareEdge;
inline constexpr int kRingEdge = kSquareEdge + 2;     // with the samples around it
inline constexpr int kSquareTexels = kRingEdge * kRingEdge;
inline constexpr int kSquareTexelBytes = 3 * kSquareTexels;
/// Renderers read the texels of a channel as two vectors of 64 bytes.
inline constexpr int kTexelPadding = 128 - kSquareTexels;

struct PieceSquare {
  std::uint16_t column = 0, row = 0;  // on the face, of the sample (0, 0)
  std::uint32_t first_piece = 0;      // its pieces reach to the next square's
  /// Index of its 64 reaches (pack_reach()), or kAllConnected: one piece holds every sample and all around the square.
  std::uint32_t first_reach = 0;
  float lowest = 0, highest = 0;      // disparities within one sample of its pieces' samples
};

/// What kGroupSquares squares that follow each other have in common.
struct SquareGroup {
  std::uint16_t first_column = 0, last_column = 0, first_row = 0, last_row = 0;  // of the squares' samples (0, 0)
  float lowest = 0, highest = 0;
};
inline constexpr std::size_t kGroupSquares = 16;

struct SurfacePiece {
  std::uint64_t own = 0;  // bit 8·j + i: sample (i, j) is the piece's
  float disparity = 0, slope_u = 0, slope_v = 0;  // at sample (0, 0) of the square, and per sample
  /// Bit i + 1 of held[j + 1] tells that sample (i, j), in the square or beside it, is of the same surface.
  std::array<std::uint16_t, kRingEdge> held{};
};

struct SurfacePieces {
  static constexpr std::uint32_t kAllConnected = ~0u;

  std::vector<PieceSquare> squares;
  std::vector<SquareGroup> groups;
  std::vector<SurfacePiece> pieces;
  std::vector<std::uint16_t> reach;   // 64 per square that has them, by rows; of samples in no piece 0
  std::vector<std::uint8_t> texels;   // [square][RGB][row + 1][column + 1], sRGB, and kTexelPadding bytes
  std::uint32_t samples = 0;          // in pieces

  std::size_t piece_end(std::size_t square) const {
    return square + 1 < squares.size() ? squares[square + 1].first_piece : pieces.size();
  }
  std::size_t memory_bytes() const;   // on the heap
};

/// Which samples of a tile's arrays are in pieces.
using InPieces = std::vector<std::uint8_t>;

/// `in_pieces` gets 1 for every sample that is in a piece; others must be drawn one by one. Pieces leave no sample farther
/// off than an eighth of the tile's tolerance; a tile without tolerance has none. Those a tile leaves to its neighbours
/// (DrawnSamples) are in none. O(samples).
SurfacePieces find_surface_pieces(const Tile& tile, InPieces& in_pieces);

}  // namespace farfield

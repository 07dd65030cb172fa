// SPDX-License-Identifier: Apache-2.0
// A plane piece of a surface, placed on the screen: which place of its square each pixel shows, by one linear map there and
// back, and how it is drawn.
//
// A square's sample (i, j) is at P + i·P_u + j·P_v in (X, Y, w), see tile_projection.h: a plane's disparity is linear in i
// and j. With M = (P_u, P_v, P), a pixel (x, y) shows (i, j, 1)·1/w = M⁻¹·(x, y, 1)·1: three numbers linear in x and y, of
// which the third is 1/w. The eye disparity, (d + i·d_u + j·d_v)/w, is linear in them, so in x and y too.
//
// Based on: Heckbert 1989, section 2.2.3 (projective maps inferred from matrices, drawn by scan lines). Differs: eye disparity beside
// the texture coordinates, ends of surfaces sample by sample.
#pragma once

#include <cstdint>

#include "client/warp/project_row.h"
#include "client/warp/tile_projection.h"
#include "common/impostor/splats.h"

namespace farfield::client {

/// origin + x·along_x + y·along_y, pixels counted from PlacedPiece's origin.
struct ScreenLinear {
  float origin = 0, along_x = 0, along_y = 0;
};

/// Positions in a square are in 256ths of a sample.
inline constexpr int kPositionSteps = 256;

struct PlacedPiece {
  int left = 0, right = -1, top = 0, bottom = -1;  // pixels it may cover, clipped
  int origin_x = 0, origin_y = 0;                  // the same whatever the window is
  ScreenLinear column, row;                        // 256·i/w, 256·j/w
  ScreenLinear per_w;                              // 1/w
  ScreenLinear disparity;                          // of the eye, per metre, kFootprintPenalty taken off
  /// No sample is drawn farther from its own place than this along a row, a column of the face, 256ths of a sample:
  /// kMaxReach pixels. It ends surfaces that are seen nearly edge-on, of which little is known.
  int farthest_u = kPositionSteps, farthest_v = kPositionSteps;
  const SurfacePiece* piece = nullptr;
  const std::uint16_t* reach = nullptr;            // 64; null: all connected, and the piece all there is
  const std::uint8_t* texels = nullptr;
};

/// Returns: false if no pixel of the window can show the piece.
bool place_piece(const TileProjection& projection, const Splats& splats, const PieceSquare& square,
                 const SurfacePiece& piece, const PixelWindow& window, PlacedPiece& placed);

/// Draws it into rows of `width` keys. By vectors where the machine has what it takes (AVX-512), else draw_piece_scalar().
/// Returns: false if no key can have changed.
bool draw_piece(const PlacedPiece& placed, int width, std::uint64_t* keys);
/// The reference: the same pixels and keys, one after another.
void draw_piece_scalar(const PlacedPiece& placed, int width, std::uint64_t* keys);

}  // namespace farfield::client

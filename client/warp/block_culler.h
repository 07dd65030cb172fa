// SPDX-License-Identifier: Apache-2.0
// Which squares of a tile's samples can change a window of the screen: those that can land in it, in front of what is
// there already. Tiles come nearest shell first, so most of what a viewer in a dense scene cannot see ends here.
//
// Never leaves out a sample that would change a key: the picture is the same with and without it.
//
// Based on: Greene, Kass & Miller 1993 (hierarchical visibility), see shown_depths.h.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "client/warp/project_row.h"
#include "client/warp/shown_depths.h"
#include "client/warp/tile_projection.h"
#include "common/impostor/splats.h"

namespace farfield::client {

/// For each row of splats.blocks: bit c tells that the square in column c is to be drawn.
using VisibleBlocks = std::array<std::uint32_t, SplatBlocks::kColumns>;

/// `shown` learns where the squares to be drawn are.
VisibleBlocks find_visible_blocks(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                  ShownDepths& shown);

/// The same for groups [begin, end) of squares of plane pieces, at most kColumns of them: bit k tells that some of group
/// begin + k may be to be drawn.
std::uint32_t find_visible_groups(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                  ShownDepths& shown, std::size_t begin, std::size_t end);
/// And for the squares themselves, [begin, end) of splats.pieces.squares, at most kColumns of them: bit k tells that
/// square begin + k is to be drawn.
std::uint32_t find_visible_squares(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                                   ShownDepths& shown, std::size_t begin, std::size_t end);

/// Has the memory of a square's samples brought closer: they are read in an order that no machine foresees.
inline void fetch_square(const SurfacePieces& pieces, std::size_t square) {
  constexpr std::size_t kLine = 64;  // bytes of a cache line
  const std::uint8_t* texels = &pieces.texels[square * kSquareTexelBytes];
  for (std::size_t at = 0; at < kSquareTexelBytes; at += kLine) __builtin_prefetch(texels + at);
  const std::uint32_t reach = pieces.squares[square].first_reach;
  if (reach != SurfacePieces::kAllConnected) {
    __builtin_prefetch(&pieces.reach[reach]);
    __builtin_prefetch(&pieces.reach[reach + kSquareSamples / 2]);
  }
  __builtin_prefetch(&pieces.pieces[pieces.squares[square].first_piece]);
}

/// Calls f(square) for all that are to be drawn, each asked for after those of the groups before were drawn.
template <class F>
void for_each_visible_square(const TileProjection& projection, const Splats& splats, const PixelWindow& window,
                             ShownDepths& shown, F&& f) {
  const std::size_t groups = splats.pieces.groups.size(), squares = splats.pieces.squares.size();
  const auto place = [](std::uint32_t bits) { return static_cast<std::size_t>(std::countr_zero(bits)); };
  for (std::size_t first = 0; first < groups; first += SplatBlocks::kColumns) {
    const std::size_t last = std::min(first + SplatBlocks::kColumns, groups);
    for (std::uint32_t left = find_visible_groups(projection, splats, window, shown, first, last); left != 0; left &= left - 1) {
      const std::size_t begin = (first + place(left)) * kGroupSquares;
      std::uint32_t visible = find_visible_squares(projection, splats, window, shown, begin, std::min(begin + kGroupSquares, squares));
      for (std::uint32_t soon = visible; soon != 0; soon &= soon - 1) fetch_square(splats.pieces, begin + place(soon));
      for (; visible != 0; visible &= visible - 1) f(begin + place(visible));
    }
  }
}

}  // namespace farfield::client

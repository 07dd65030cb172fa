// SPDX-License-Identifier: Apache-2.0
// The reference: one pixel after another.
#include <algorithm>
#include <array>
#include <cmath>

#include "client/warp/piece_on_screen.h"
#include "client/warp/splat_key.h"
#include "client/warp/write_pixels.h"

namespace farfield::client {
namespace {

float value_at(const ScreenLinear& f, int x, int y) {
  return (f.origin + f.along_y * static_cast<float>(y)) + f.along_x * static_cast<float>(x);
}

/// The place in a square that a pixel shows: between samples (i, j) and (i + 1, j + 1), at (x, y) 256ths of the way.
struct Place {
  int i, j, x, y;
};

bool holds(const SurfacePiece& piece, int i, int j) { return (piece.held[j + 1] >> (i + 1) & 1) != 0; }
bool owns(const SurfacePiece& piece, int i, int j) {
  return i >= 0 && j >= 0 && i < kSquareEdge && j < kSquareEdge && (piece.own >> (kSquareEdge * j + i) & 1) != 0;
}

/// Whether the surface of the sample at one of the place's corners reaches it.
bool is_reached_from(const PlacedPiece& placed, const Place& place, int right, int down) {
  const int i = place.i + right, j = place.j + down;
  if (!owns(*placed.piece, i, j)) return false;
  const unsigned reach = placed.reach ? placed.reach[kSquareEdge * j + i] : kReachAllConnected;
  const int to_x = right ? kPositionSteps - place.x : place.x, to_y = down ? kPositionSteps - place.y : place.y;
  const int reach_x = std::min(static_cast<int>(reach >> (right ? 0 : 4) & 15) * 16, placed.farthest_u);
  const int reach_y = std::min(static_cast<int>(reach >> (down ? 8 : 12) & 15) * 16, placed.farthest_v);
  return to_x <= reach_x + 1 && to_y <= reach_y + 1;  // kRoundingMargin
}

/// Bilinear between the corners of the surface; a corner that is not has its share taken by the other in its row, a row
/// without any by the other row.
std::array<int, 4> weights_of(const SurfacePiece& piece, const Place& place) {
  std::array<std::array<bool, 2>, 2> held;
  for (int row = 0; row < 2; ++row)
    for (int k = 0; k < 2; ++k) held[row][k] = holds(piece, place.i + k, place.j + row);
  const bool any_up = held[0][0] || held[0][1], any_down = held[1][0] || held[1][1];
  const int down = !any_up ? 128 : any_down ? place.y >> 1 : 0;
  std::array<int, 4> weights{};
  for (int k = 0; k < 2; ++k) {
    const int share = k ? place.x : kPositionSteps - place.x;
    weights[2 + k] = share * down >> 7;
    weights[k] = share - weights[2 + k];
  }
  for (int row = 0; row < 2; ++row) {
    const int left = weights[2 * row], right = weights[2 * row + 1];
    weights[2 * row] = held[row][0] ? left + (held[row][1] ? 0 : right) : 0;
    weights[2 * row + 1] = held[row][1] ? right + (held[row][0] ? 0 : left) : 0;
  }
  return weights;
}

std::uint32_t colour_at(const PlacedPiece& placed, const Place& place) {
  const std::array<int, 4> weights = weights_of(*placed.piece, place);
  std::uint32_t colour = 0;
  for (int c = 0; c < 3; ++c) {
    const std::uint8_t* texel = placed.texels + kSquareTexels * c + kRingEdge * (place.j + 1) + place.i + 1;
    const int sum = weights[0] * texel[0] + weights[1] * texel[1] + weights[2] * texel[kRingEdge] + weights[3] * texel[kRingEdge + 1];
    colour |= static_cast<std::uint32_t>((sum + 128) >> 8) << (8 * c);
  }
  return colour;
}

/// Where surfaces overlap, the one whose sample is closer wins, see kDistancePenalty.
float disparity_at(const PlacedPiece& placed, const Place& place, int x, int y) {
  const int to_x = std::min(place.x, kPositionSteps - place.x), to_y = std::min(place.y, kPositionSteps - place.y);
  constexpr float kPenalty = kDistancePenalty / (kPositionSteps * kPositionSteps);
  const float disparity = value_at(placed.disparity, x, y) * (1.0f - kPenalty * static_cast<float>(to_x * to_x + to_y * to_y));
  return disparity > 0 ? disparity : 0.0f;
}

}  // namespace

void draw_piece_scalar(const PlacedPiece& placed, int width, std::uint64_t* keys) {
  // All that has samples at its corners, once rounded.
  constexpr float kFirst = -kPositionSteps - 0.5f, kLast = kSquareEdge * kPositionSteps - 0.5f;
  for (int line = placed.top; line <= placed.bottom; ++line) {
    const int y = line - placed.origin_y;
    for (int pixel = placed.left; pixel <= placed.right; ++pixel) {
      const int x = pixel - placed.origin_x;
      const float per_w = value_at(placed.per_w, x, y), w = 1.0f / per_w;
      const float column = value_at(placed.column, x, y) * w, row = value_at(placed.row, x, y) * w;
      if (!(per_w > 0 && column > kFirst && column < kLast && row > kFirst && row < kLast)) continue;
      const int at_x = static_cast<int>(std::nearbyint(column)), at_y = static_cast<int>(std::nearbyint(row));
      const Place place{at_x >> 8, at_y >> 8, at_x & 255, at_y & 255};
      bool is_reached = false;
      for (int corner = 0; corner < 4; ++corner) is_reached |= is_reached_from(placed, place, corner & 1, corner >> 1);
      if (!is_reached) continue;
      keep_larger(keys[static_cast<std::size_t>(line) * static_cast<std::size_t>(width) + static_cast<std::size_t>(pixel)],
                  make_key(key_high(disparity_at(placed, place, x, y)), colour_at(placed, place)));
    }
  }
}

}  // namespace farfield::client

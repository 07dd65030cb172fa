// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "client/warp/piece_on_screen.h"

namespace farfield::client {
namespace {

/// How far a square's surface reaches beyond its outermost samples, where it ends at cuts and where it goes on.
constexpr double kFarthestReach = 15.0 / 16.0 + kRoundingMargin;
constexpr double kConnectedReach = kReachConnected / 16.0 + kRoundingMargin;
/// Pixels farther off than this are in no frame; ints hold them.
constexpr double kFarOff = 1 << 20;

/// The samples of a piece, and what lies around them, in samples.
struct Extent {
  double left, right, top, bottom;
  Extent(const SurfacePiece& piece, bool is_whole) {
    std::uint64_t folded = piece.own | piece.own >> 32;
    folded |= folded >> 16;
    const auto columns = static_cast<std::uint32_t>((folded | folded >> 8) & 0xff);
    const double reach = is_whole ? kConnectedReach : kFarthestReach;
    left = std::countr_zero(columns) - reach, right = std::bit_width(columns) - 1 + reach;
    top = std::countr_zero(piece.own) / kSquareEdge - reach;
    bottom = (std::bit_width(piece.own) - 1) / kSquareEdge + reach;
  }
};

int whole_pixel(double value) { return static_cast<int>(std::clamp(value, -kFarOff, kFarOff)); }

ScreenLinear linear(const glm::dvec3& row, double scale) {
  return {static_cast<float>(row.z * scale), static_cast<float>(row.x * scale), static_cast<float>(row.y * scale)};
}

/// The pixels whose centres lie within the corners; everything if one of them is not in front of the eye.
void find_pixels(const Extent& extent, const glm::dvec3& p, const glm::dvec3& p_u, const glm::dvec3& p_v, PlacedPiece& placed) {
  double x_low = kFarOff, x_high = -kFarOff, y_low = kFarOff, y_high = -kFarOff;
  for (const double i : {extent.left, extent.right}) {
    for (const double j : {extent.top, extent.bottom}) {
      const glm::dvec3 at = p + i * p_u + j * p_v;
      if (!(at.z > 0)) {
        placed.left = placed.top = -whole_pixel(kFarOff), placed.right = placed.bottom = whole_pixel(kFarOff);
        return;
      }
      const double per_w = 1.0 / at.z, x = at.x * per_w, y = at.y * per_w;
      x_low = std::min(x_low, x), x_high = std::max(x_high, x);
      y_low = std::min(y_low, y), y_high = std::max(y_high, y);
    }
  }
  placed.left = placed.origin_x + whole_pixel(std::ceil(x_low)), placed.right = placed.origin_x + whole_pixel(std::floor(x_high));
  placed.top = placed.origin_y + whole_pixel(std::ceil(y_low)), placed.bottom = placed.origin_y + whole_pixel(std::floor(y_high));
}

/// See PlacedPiece. `along`: how (X, Y, w) changes per sample at a place `per_w` = 1/w, its pixel (x, y).
int farthest_along(const glm::dvec3& along, double x, double y, double per_w) {
  const double pixels = std::max(std::fabs(along.x - x * along.z), std::fabs(along.y - y * along.z)) * per_w;  // per sample
  if (!(pixels > kMaxReach)) return kPositionSteps;
  return static_cast<int>(kMaxReach * kPositionSteps / pixels);
}

constexpr std::array<std::uint16_t, kSquareSamples> all_connected() {
  std::array<std::uint16_t, kSquareSamples> reaches{};
  for (std::uint16_t& reach : reaches) reach = kReachAllConnected;
  return reaches;
}
constexpr std::array<std::uint16_t, kSquareSamples> kAllConnectedReaches = all_connected();

}  // namespace

bool place_piece(const TileProjection& projection, const Splats& splats, const PieceSquare& square,
                 const SurfacePiece& piece, const PixelWindow& window, PlacedPiece& placed) {
  const double pitch = splats.pitch, d = piece.disparity, d_u = piece.slope_u, d_v = piece.slope_v;
  glm::dvec3 p = projection.at(splats.tangent(square.column), splats.tangent(square.row), d);
  glm::dvec3 p_u = pitch * projection.per_u + d_u * projection.per_disparity;
  glm::dvec3 p_v = pitch * projection.per_v + d_v * projection.per_disparity;
  // Pixels are counted from the one at the square's middle: numbers stay small, and floats are enough.
  constexpr double kMiddle = 0.5 * (kSquareEdge - 1);
  const glm::dvec3 middle = p + kMiddle * (p_u + p_v);
  const double middle_per_w = 1.0 / middle.z, middle_x = middle.x * middle_per_w, middle_y = middle.y * middle_per_w;
  const bool is_in_front = middle.z > 0;
  placed.origin_x = is_in_front ? whole_pixel(middle_x) : 0, placed.origin_y = is_in_front ? whole_pixel(middle_y) : 0;
  const double centre_x = placed.origin_x + 0.5, centre_y = placed.origin_y + 0.5;
  for (glm::dvec3* column : {&p, &p_u, &p_v}) column->x -= centre_x * column->z, column->y -= centre_y * column->z;
  const bool is_whole = square.first_reach == SurfacePieces::kAllConnected;
  find_pixels(Extent(piece, is_whole), p, p_u, p_v, placed);
  placed.left = std::max(placed.left, 0), placed.right = std::min(placed.right, window.width - 1);
  placed.top = std::max(placed.top, window.top), placed.bottom = std::min(placed.bottom, window.bottom - 1);
  if (placed.left > placed.right || placed.top > placed.bottom) return false;

  const glm::dvec3 by_i = glm::cross(p_v, p), by_j = glm::cross(p, p_u), by_w = glm::cross(p_u, p_v);
  const double volume = glm::dot(p_u, by_i), per_volume = 1.0 / volume;  // seen edge-on it is infinite: no pixel passes the tests then
  placed.column = linear(by_i, kPositionSteps * per_volume), placed.row = linear(by_j, kPositionSteps * per_volume);
  placed.per_w = linear(by_w, per_volume);
  // Pixels per sample at the middle: the volume over w³.
  const double area = std::fabs(volume * middle_per_w * middle_per_w * middle_per_w);
  const double footprint = area > 1 ? std::min(area - 1, double{kLargestFootprint}) : 0;
  placed.disparity = linear(d * by_w + d_u * by_i + d_v * by_j,
                            per_volume * projection.disparity_scale * (1 - kFootprintPenalty * footprint));
  placed.piece = &piece;
  const auto index = static_cast<std::size_t>(&square - splats.pieces.squares.data());
  placed.farthest_u = placed.farthest_v = kPositionSteps;
  if (is_in_front) {
    placed.farthest_u = farthest_along(p_u, middle_x - centre_x, middle_y - centre_y, middle_per_w);
    placed.farthest_v = farthest_along(p_v, middle_x - centre_x, middle_y - centre_y, middle_per_w);
  }
  const bool is_cut_short = std::min(placed.farthest_u, placed.farthest_v) < kConnectedReach * kPositionSteps;
  placed.reach = is_whole ? (is_cut_short ? kAllConnectedReaches.data() : nullptr) : &splats.pieces.reach[square.first_reach];
  placed.texels = &splats.pieces.texels[index * kSquareTexelBytes];
  return true;
}

}  // namespace farfield::client

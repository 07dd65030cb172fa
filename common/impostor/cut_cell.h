// SPDX-License-Identifier: Apache-2.0
// How one grid cell, the square between four neighbouring samples, is divided among the surfaces at its corners.
//
// Corners go round the cell: 0 = (0,0), 1 = (1,0), 2 = (1,1), 3 = (0,1); edge k joins corners k and k+1 (mod 4).
// Corners joined through uncut edges belong to one surface; neighbouring corners without any surface belong to the
// void. The groups are arcs of the ring, so only five patterns exist: {4}, {3,1}, {2,2}, {2,1,1}, {1,1,1,1}. Their
// polygons are convex and tile the cell exactly: nothing overlaps, and only the void's share stays empty.
//
// Based on: the marching-squares table, extended to more than two labels. Differs: cut points stand where the edge
// was bisected, not at interpolated values.
#pragma once

#include <array>
#include <cstdint>

namespace farfield {

struct CellPoint {
  float x = 0, y = 0;  // in samples from corner 0
};

struct CutCell {
  std::array<bool, 4> is_covered{};  // corner k holds a surface
  std::array<bool, 4> is_joined{};   // edge k joins its corners: both covered and uncut, or both uncovered
  std::array<float, 4> cut{};        // where edge k is cut, as its coordinate x (edges 0, 2) or y (edges 1, 3), 0 … 1
};

/// One point of a polygon: a corner, the cut point of an edge, or the inner point of the cell.
struct PolygonPoint {
  enum Kind : std::uint8_t { kCorner, kCut, kInner } kind = kCorner;
  std::uint8_t index = 0;   // of the corner or edge
  std::uint8_t corner = 0;  // the corner whose surface the point continues: its end of the cut edge
};

struct CellPolygon {
  int size = 0;                        // 3 … 5
  std::array<PolygonPoint, 5> points;  // round a convex polygon, beginning with a corner
};

struct CellPartition {
  int size = 0;  // polygons of covered groups, at most 4
  std::array<CellPolygon, 4> polygons;
  CellPoint inner;  // where kInner points stand
};

CellPartition divide_cell(const CutCell& cell);

inline constexpr CellPoint corner_point(int corner) {
  return {corner == 1 || corner == 2 ? 1.0f : 0.0f, corner >= 2 ? 1.0f : 0.0f};
}
inline constexpr CellPoint cut_point(const CutCell& cell, int edge) {
  switch (edge) {
    case 0: return {cell.cut[0], 0.0f};
    case 1: return {1.0f, cell.cut[1]};
    case 2: return {cell.cut[2], 1.0f};
    default: return {0.0f, cell.cut[3]};
  }
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/cut_cell.h"

#include <cmath>

namespace farfield {
namespace {

int next(int k) { return (k + 1) & 3; }
int previous(int k) { return (k + 3) & 3; }

/// Where the two lines through opposite cut points cross. Cuts lie strictly inside their edges, so they do.
CellPoint crossing(const CutCell& cell) {
  const float top = cell.cut[0], right = cell.cut[1], bottom = cell.cut[2], left = cell.cut[3];
  const float x = (top + (bottom - top) * left) / (1.0f - (bottom - top) * (right - left));
  return {x, left + (right - left) * x};
}

/// One pair of joined corners and two single ones: the singles part at a point of the line that borders the pair.
CellPoint pair_border_point(const CutCell& cell, int joined_edge) {
  const int opposite = (joined_edge + 2) & 3;
  const CellPoint from = cut_point(cell, previous(joined_edge)), to = cut_point(cell, next(joined_edge));
  const CellPoint start = corner_point(next(opposite)), cut = cut_point(cell, opposite);
  const float share = std::abs(cut.x - start.x) + std::abs(cut.y - start.y);  // one of the terms is zero
  return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
}

CellPolygon whole_cell() {
  CellPolygon polygon;
  polygon.size = 4;
  for (std::uint8_t k = 0; k < 4; ++k) polygon.points[k] = {PolygonPoint::kCorner, k, k};
  return polygon;
}

}  // namespace

CellPartition divide_cell(const CutCell& cell) {
  CellPartition partition;
  int joined = 0, joined_edge = 0;
  for (int k = 0; k < 4; ++k) {
    if (!cell.is_joined[k]) continue;
    ++joined;
    joined_edge = k;
  }
  if (joined >= 3) {  // one surface; where the fourth edge is cut, the tear ends inside the cell
    if (cell.is_covered[0]) partition.polygons[partition.size++] = whole_cell();
    return partition;
  }
  if (joined == 1) partition.inner = pair_border_point(cell, joined_edge);
  if (joined == 0) partition.inner = crossing(cell);

  for (int first = 0; first < 4; ++first) {
    if (cell.is_joined[previous(first)] || !cell.is_covered[first]) continue;  // not the first of its group, or void
    CellPolygon polygon;
    const auto add = [&](PolygonPoint::Kind kind, int index, int corner) {
      polygon.points[polygon.size++] = {kind, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(corner)};
    };
    int last = first;
    add(PolygonPoint::kCorner, first, first);
    while (cell.is_joined[last]) {
      last = next(last);
      add(PolygonPoint::kCorner, last, last);
    }
    add(PolygonPoint::kCut, last, last);
    if (first == last && joined < 2) add(PolygonPoint::kInner, 0, first);
    add(PolygonPoint::kCut, previous(first), first);
    partition.polygons[partition.size++] = polygon;
  }
  return partition;
}

}  // namespace farfield

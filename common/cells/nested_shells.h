// SPDX-License-Identifier: Apache-2.0
// The nested shells around a viewer (design.md section 2): which part of space which cell's impostor stands for.
//
// near_region(C) is box(C) grown by kappa·side; shell(C) is near_region(parent(C)) without near_region(C). For a leaf
// and its ancestors these tile space exactly: near_region(C) lies inside near_region(parent(C)), every face at least
// kappa·side away, because box(C) lies in box(parent) and the parent's margin is 2·kappa·side.
// All boxes are half-open, so every point belongs to exactly one part, borders included.
#pragma once

#include "common/cells/cell_id.h"

namespace farfield {

struct NestedShells {
  CellGrid grid;
  double kappa = 2.0;

  Box near_region(const CellId& cell) const { return grid.box(cell).grown(kappa * grid.side_m(cell.level)); }

  /// What a fallback view leaves to near geometry, in sides around its cell. design.md section 2 has it begin at the cell's
  /// own box; there surfaces that touch the box are stretched without bound and a third of a frame in a corridor was void.
  /// From a margin of one side a surface that faces the view is magnified at most (1/2 + 1)/1 = 1.5 times.
  static constexpr double kFallbackKappa = 1.0;
  Box fallback_region(const CellId& cell) const { return grid.box(cell).grown(kFallbackKappa * grid.side_m(cell.level)); }

  static constexpr int kNear = -1;
  /// The level of the shell that holds `point` for a viewer in `leaf`, kNear inside the leaf's near region. The
  /// root's shell reaches to infinity. Requires: root is an ancestor of leaf (or leaf itself).
  int shell_at(const CellId& leaf, const CellId& root, const glm::dvec3& point) const {
    if (near_region(leaf).contains(point)) return kNear;
    for (int level = leaf.level; level < root.level; ++level)
      if (near_region(leaf.ancestor(level + 1)).contains(point)) return level;
    return root.level;
  }
};

}  // namespace farfield

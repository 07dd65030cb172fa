// SPDX-License-Identifier: Apache-2.0
// The geometry one cell's impostor is made in: its boxes, and rays clipped to its shell.
#pragma once

#include "common/cells/nested_shells.h"
#include "common/impostor/settings.h"
#include "server/visibility/sphere_rays.h"

namespace farfield {

/// Everything in the scene frame, metres.
struct CellSpace {
  CellId cell;
  Box box;           // of viewpoints
  double side_m = 1;
  RayClip shell;     // rays begin where they leave the near region and end where they leave the parent's

  /// The shell of a cell; the root's reaches to infinity, which no later code needs to know: its ancestors' near
  /// regions hold the scene anyway.
  static CellSpace of_shell(const NestedShells& shells, const CellId& cell, const CellId& root) {
    CellSpace space{cell, shells.grid.box(cell), shells.grid.side_m(cell.level), {}};
    space.shell.inside = shells.near_region(cell);
    if (cell.level < root.level) space.shell.outside = shells.near_region(cell.parent());
    return space;
  }
  /// What the fallback view shows: NestedShells::kFallbackKappa.
  static CellSpace of_fallback(const NestedShells& shells, const CellId& cell) {
    CellSpace space{cell, shells.grid.box(cell), shells.grid.side_m(cell.level), {}};
    space.shell.inside = shells.fallback_region(cell);
    return space;
  }
  bool contains(const glm::dvec3& point) const { return shell.outside.contains(point) && !shell.inside.contains(point); }
};

/// True if the segment from `view` to a surface point is free within the shell. What lies within `slack` (relative to the distance)
/// in front of the point counts as the point itself: it is derived from the disparity tolerance, below which the two
/// cannot be told apart in any warped frame.
inline void set_segment(RayPacket& rays, int lane, const glm::dvec3& view, const glm::dvec3& point, const CellSpace& space,
                        double slack) {
  set_ray(rays, lane, view, point - view, RayClip{space.shell.inside, {}});
  rays.far[lane] = static_cast<float>(1.0 - slack);
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// How much of what viewers in a cell see in its shell no view holds: counted with rays that had no part in choosing the views.
//
// Differs from the search for views (shell_views.h): viewpoints are scattered over the cell instead of standing at its
// corners, and a ray begins at the viewpoint: what near things and nearer shells hide is no void that anyone sees. Shares
// are of all directions, so those of shells around one viewer add up.
#pragma once

#include <atomic>
#include <vector>

#include "common/impostor/certificate.h"
#include "server/impostor/cell_space.h"

namespace farfield {

struct VoidCount {
  /// The same counts had the views ended earlier.
  struct Left {
    std::uint32_t hits = 0, worst_hits = 0;
  };
  std::uint32_t rays = 0, hits = 0;              // all viewpoints
  std::uint32_t worst_rays = 0, worst_hits = 0;  // the one that sees most voids
  glm::dvec3 worst{0};                           // where it stands, scene frame
  std::vector<Left> left;                        // after the first view, the first two, …: the last is what is counted above

  void store_in(Certificate& certificate) const;
};

/// `round`: each gives viewpoints and directions of its own. `slack`: of set_segment(). Deterministic: depends on scene, cell,
/// views and round only. Some 40 000 rays, and one more per view for each that meets the shell.
/// Returns: no rays if no viewpoint is free or the work is cancelled.
VoidCount count_voids(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, double slack, int round,
                      const std::atomic<bool>* cancel);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// The leaf cells that viewers of the trace stand in, as Farfield divides the scene, for figures that all methods are
// asked for: which pixels are far, and which frames lie on two sides of a border. Thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "common/cells/nested_shells.h"
#include "common/impostor/settings.h"
#include "server/cells/cell_tree.h"
#include "server/scene/reference_image.h"

namespace farfield::bench {

class ViewerCells {
 public:
  /// Requires: settings.finest_side_m suits the scene (finest_side_for).
  ViewerCells(std::shared_ptr<const Scene> scene, const ImpostorSettings& settings);

  /// Scene frame. May cast rays the first time a region is asked for.
  CellId leaf_at(const glm::dvec3& viewpoint) const;

  /// 1 for each pixel whose true surface, the hit of the ray nearest the pixel's centre, lies outside the near region of
  /// the eye's leaf cell: what an impostor shows, whatever method drew it. 0 where truth has no surface.
  std::vector<std::uint8_t> far_pixels(const Pose& eye, const Display& display, const ReferenceImage& truth) const;

 private:
  NestedShells shells_;
  std::shared_ptr<CellTree> tree_;
};

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/viewer_cells.h"

namespace farfield::bench {

ViewerCells::ViewerCells(std::shared_ptr<const Scene> scene, const ImpostorSettings& settings)
    : shells_{CellGrid{settings.finest_side_m}, settings.kappa},
      tree_(std::make_shared<CellTree>(std::move(scene), shells_, settings.near_triangles)) {}

CellId ViewerCells::leaf_at(const glm::dvec3& viewpoint) const {
  return *tree_->leaf_at(viewpoint, nullptr);  // fails only if cancelled
}

std::vector<std::uint8_t> ViewerCells::far_pixels(const Pose& eye, const Display& display, const ReferenceImage& truth) const {
  const Box near = shells_.near_region(leaf_at(eye.position));
  const glm::dmat3 rotation(glm::mat3_cast(eye.world_from_camera));
  std::vector<std::uint8_t> is_far(truth.disparity.size());
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * truth.width + x;
      if (!truth.has_surface[at] || !(truth.disparity[at] > 0)) continue;
      const glm::dvec3 direction = rotation * camera_direction(display, x + 0.5, y + 0.5);
      is_far[at] = !near.contains(eye.position + direction / static_cast<double>(truth.disparity[at]));
    }
  return is_far;
}

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/simple_impostors.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace farfield::bench {

double billboard_disparity(const FarView& view, const CellSpace& space) {
  std::vector<float> found;
  for (const FarFace& face : view.faces)
    for (std::size_t k = 0; k < face.disparity.size(); ++k)
      if (face.covered[k]) found.push_back(face.disparity[k]);
  if (found.empty()) return 0;
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
  std::nth_element(found.begin(), middle, found.end());
  // The farthest face of the near region from the view, which reaches farther than rays begin.
  const glm::dvec3 reach = glm::max(space.shell.inside.max - view.position, view.position - space.shell.inside.min);
  return std::min(double{*middle}, space.side_m / (std::max({reach.x, reach.y, reach.z}) + kOverlapSides * space.side_m));
}

std::vector<MeshPanel> make_billboard(const FarView& view, const CellSpace& space) {
  const auto disparity = static_cast<float>(billboard_disparity(view, space));
  std::vector<MeshPanel> panels;
  for (const FarFace& face : view.faces) {
    MeshPanel panel{face.frame, face.face, {}, face.rgb, {}};
    // From tangent -1 to 1: to the cube's edges.
    const float low = 1, high = static_cast<float>(face.edge() - 1);
    panel.mesh.vertices = {{low, low, disparity}, {high, low, disparity}, {low, high, disparity}, {high, high, disparity}};
    panel.mesh.indices = {0, 2, 1, 1, 2, 3};
    panels.push_back(std::move(panel));
  }
  return panels;
}

std::vector<MeshPanel> make_depth_sheet(const FarView& view, const CellSpace& space, double error_px, const Display& display, double kappa) {
  std::vector<MeshPanel> panels(view.faces.size());
  tbb::parallel_for(std::size_t{0}, panels.size(), [&](std::size_t f) {
    const FarFace& face = view.faces[f];
    panels[f] = {face.frame, face.face, rubber_sheet(face), face.rgb, {}};
    const MeshTolerance tolerance = MeshTolerance::of(space, face.frame, error_px, display, kappa);
    simplify(panels[f].mesh, tolerance.disparity, tolerance.outline);
    panels[f].wanted = blocks_under(panels[f].mesh, face.edge());
  });
  return panels;
}

}  // namespace farfield::bench

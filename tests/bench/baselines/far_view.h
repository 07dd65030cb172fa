// SPDX-License-Identifier: Apache-2.0
// What all baselines sample: everything beyond a cell's near region, to infinity, as range images on cube faces. They
// know no nested shells: one cell's impostor stands for the whole far field, as in the papers.
//
// Samples are cast and shaded by the same functions as Farfield's own views, one ray each, so that methods differ in what
// they do with samples and not in the samples.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/impostor/view_frame.h"

namespace farfield::bench {

/// One face of one view. Arrays are [row][column] over edge × edge samples (common/math/cube_face.h).
struct FarFace {
  ViewFrame frame;
  int face = 0;
  std::vector<std::uint8_t> covered;  // 1: a surface; 0: the background
  std::vector<float> disparity;       // 1/side, along the face's axis; 0 for the background
  std::vector<std::uint8_t> rgb;      // sRGB; the background's colour where there is no surface

  int edge() const { return frame.edge_samples; }
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(edge()) + static_cast<std::size_t>(i); }
  bool holds(int i, int j) const { return i >= 0 && j >= 0 && i < edge() && j < edge(); }
  /// Scene frame. Requires: the sample at (i, j) is covered.
  glm::dvec3 point(int i, int j) const {
    return frame.position + frame.direction(i, j) * (frame.side_m / double{disparity[at(i, j)]});
  }
};

/// A panorama: the six faces around one viewpoint.
struct FarView {
  glm::dvec3 position{0};
  std::array<FarFace, kCubeFaces> faces;
};

/// Where a face's image shows a point: fractional sample indices, and the disparity it would have there.
struct FacePlace {
  double i = 0, j = 0, disparity = 0;
};
/// Returns: nothing if the point lies behind the face's view or outside its grid.
std::optional<FacePlace> place_on(const ViewFrame& frame, const glm::dvec3& point);
/// The face of a view at `position` that a point falls on. Requires: they differ.
inline int face_towards(const glm::dvec3& position, const glm::dvec3& point) { return dominant_face(point - position); }

/// The space of a leaf's one impostor: from its near region to infinity, and a little into it. Surfaces that cross the
/// border are drawn on both sides of it, as objects are that a region holds only in part (Wilson & Manocha 2003, section
/// 3.1.1): else their last sample, mixed with what lies behind the near part, would show as a seam.
inline constexpr double kOverlapSides = 0.05;  // 12 samples of 1250 at the border, or 3 on a surface seen under 15 degrees
CellSpace far_space(const NestedShells& shells, const CellId& leaf);

/// Casts edge² rays on the calling arena's TBB workers. Requires: `position` inside the space's near region.
FarFace cast_far_face(const Scene& scene, const CellSpace& space, const glm::dvec3& position, int face, int edge);
FarView cast_far_view(const Scene& scene, const CellSpace& space, const glm::dvec3& position, int edge);

}  // namespace farfield::bench

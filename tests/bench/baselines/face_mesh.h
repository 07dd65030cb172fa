// SPDX-License-Identifier: Apache-2.0
// Triangle meshes over the samples of a range image, and their simplification.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tests/bench/baselines/skins.h"

namespace farfield::bench {

struct FaceVertex {
  float column = 0, row = 0;  // in samples: sample (i, j) covers [i, i+1] × [j, j+1]; always a multiple of ½
  float disparity = 0;        // 1/side
};

struct FaceMesh {
  std::vector<FaceVertex> vertices;
  std::vector<std::uint32_t> indices;  // three per triangle; both sides count as front

  std::size_t triangles() const { return indices.size() / 3; }
};

/// A rubber sheet (Sillion et al. 1997, section 3; the standard TDM of Wilson & Manocha 2003, section 5.4): vertices at the
/// samples, joined whatever lies between them. Where it borders on the sky it goes on by one sample at the depth of what it
/// borders on, so that outlines before the sky stand where the image has them; a sheet to infinity would smear them.
FaceMesh rubber_sheet(const FarFace& face);

/// Wilson & Manocha 2003, section 4.2.1: two triangles over the whole square of each sample that is `wanted`, corner depths
/// being the mean of the samples around the corner that are one surface. Differs: one surface means connected around the
/// corner, in however many steps, so that all squares of a surface share the corner's one vertex and leave no crack.
FaceMesh surface_squares(const FarFace& face, const Adjacency& adjacency, std::span<const std::uint8_t> wanted);

/// Garland & Heckbert 1997, by meshoptimizer, in (column, row, disparity), where planes of the scene are planes: errors of
/// `tolerance` (1/side) in disparity and of `outline` samples across weigh the same. Interiors and outlines alike move by
/// about that much (Wilson & Manocha 2003, section 4.2.2: "to within half a pixel of error").
void simplify(FaceMesh& mesh, double tolerance, double outline);

}  // namespace farfield::bench

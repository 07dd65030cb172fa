// SPDX-License-Identifier: Apache-2.0
// Vertices of the 3D Voronoi diagram of a few points, cut to a box: where the next view is worth trying.
//
// Based on: Wilson & Manocha 2003, section 3.2. Differs: theirs is the planar diagram, this one is three-dimensional
// (the planar one is the special case of a flat box), and found by enumeration, as there are at most some tens of sites.
#pragma once

#include <vector>

#include "common/math/box.h"

namespace farfield {

/// Points of the box equidistant from four sites, or from three or two and on one or two faces, and no nearer to any
/// other site. O(sites^4 · sites); meant for up to about 12 sites. Corners of the box are not included.
std::vector<glm::dvec3> voronoi_vertices(const std::vector<glm::dvec3>& sites, const Box& box);

}  // namespace farfield

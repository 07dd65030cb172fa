// SPDX-License-Identifier: Apache-2.0
// Where an ITDM's samples are taken from.
//
// Based on: Wilson & Manocha 2003, sections 3.4 and 3.5: the corners of a horizontal rectangle at eye height, then the
// vertex of the 2D Voronoi diagram of the viewpoints so far (or crossing of its edges with the border) from which the
// void subtends the largest solid angle, until that falls below a threshold. Differs: the search looks at samples of 256²
// per face, not at the final ones; the skins of a sample are judged against those taken up to then, the final
// meshes' against all.
#pragma once

#include <functional>

#include "tests/bench/baselines/void_surface.h"

namespace farfield::bench {

struct ViewSearch {
  /// The paper's threshold ε, steradians. It names none, but how many samples it took: 6.3 in a house, 13 in a power plant,
  /// on average. This gives 5 and 12 in cells of the generated house and plant. Far below it, adding views stops helping:
  /// at rims every sample has a skin one sample wide, and in a plant rims are everywhere.
  double void_sr = 0.13;
  std::size_t most_views = 20;  // as many as the paper took where it followed the error (section 5.2.1)
  int void_edge = 128;          // pixels along a face on which the void is measured: 0.00013 sr each
};

struct FoundViews {
  std::vector<glm::dvec3> positions;
  std::vector<double> worst_void_sr;  // at the candidates, after four views, five, …
};

/// Vertices of the planar Voronoi diagram within a horizontal rectangle (no extent in y), and where its edges meet the border.
std::vector<glm::dvec3> planar_candidates(const std::vector<glm::dvec3>& sites, const Box& rectangle);

/// The horizontal rectangle through a box at a height, which is moved into the box if it lies outside.
Box eye_rectangle(const Box& box, double eye_height);

/// `cast`: the range images from a viewpoint, at the search's resolution.
FoundViews find_views(const Box& rectangle, double side_m, const ViewSearch& search, const std::function<FarView(const glm::dvec3&)>& cast);

}  // namespace farfield::bench

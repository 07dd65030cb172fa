// SPDX-License-Identifier: Apache-2.0
// Which of a cell's samples ("scan cubes") are drawn for a viewer.
//
// Based on: Wilson & Manocha 2003, section 4.3. Differs: the paper stops selecting by triangles once the budget is exceeded;
// here a cube that would exceed it is left out, and what follows it too, so that the budget holds. The intra cube is drawn
// whatever it costs: without it there is no picture.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace farfield::bench {

/// Section 4.1.1: the samples and each one's parent; the root is its own.
struct ScanTree {
  std::vector<glm::dvec3> positions;  // scene frame
  std::vector<std::size_t> parents;
};

/// 0: no limit.
struct ScanBudget {
  std::size_t scans = 0;      // section 4.3.1, a target for fidelity
  std::size_t triangles = 0;  // section 4.3.2, within the view
};

/// The cubes to draw, ancestors first: the one nearest to the eye with all it depends on, then the nearest of the rest, and so
/// on until the budget is spent. `triangles_in_view`: of each cube. Requires: a tree. O(n²) in cubes.
std::vector<std::size_t> select_scans(const ScanTree& tree, const glm::dvec3& eye, const ScanBudget& budget,
                                      std::span<const std::size_t> triangles_in_view);

}  // namespace farfield::bench

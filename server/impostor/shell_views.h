// SPDX-License-Identifier: Apache-2.0
// Where the views of a cell's impostor stand: fixed for the whole shell by a coarse probe, before any tile is made.
//
// Based on: Wilson & Manocha 2003, section 3 (greedy choice of the candidate that sees the most void; candidates are
// reachable corners, then vertices of the Voronoi diagram of the views so far). Differs: void is measured by rays, which
// ask of a surface point directly whether some view sees it, and not far more obliquely, instead of by drawing skins.
#pragma once

#include <atomic>
#include <vector>

#include "server/impostor/void_probe.h"

namespace farfield {

struct ShellViews {
  std::vector<glm::dvec3> positions;   // scene frame; [0] is the intra view, then delta views in order of worth
  std::vector<double> warp_gains;      // of each view (common/cells/sampling.h): a quarter of a million terms each, so once
  double void_worst_sr = 0;            // left after all views, at the worst candidate
  double void_mean_sr = 0;
  VoidCount validated;                 // with rays of its own
  int views_added_by_validation = 0;
  bool missed_target = false;          // voids above CertificateTargets::void_share, and no view left to add
  double first_void_sr = 0;            // worst before any delta view
  int delta_views_allowed = 0;
};

/// How hard to look for voids. A leaf's viewers stand within its side of each other; an inner cell is as wide as the things
/// in it, its shell is seen from many leaves, and its views are chosen once for all of them.
enum class ViewSearchWidth : std::uint8_t { kLeaf, kInnerCell };

/// Candidates are the reachable points nearest to the cell's corners, the diagram's vertices and, in inner cells, a
/// lattice of 27 points and 16 scattered ones; inner cells may have twice the delta views. Deterministic: depends on scene, settings, cell and
/// width only. Some hundred thousand rays. The views are then validated (void_probe.h); where that finds more voids than the settings'
/// target, the viewpoint that sees most becomes a view, up to kRefinements times within the budget, and is validated anew.
ShellViews choose_views(const Scene& scene, const CellSpace& space, const ImpostorSettings& settings, ViewSearchWidth width,
                        const std::atomic<bool>* cancel);

/// View positions are snapped to this fraction of the side, so that offsets are exact floats.
glm::dvec3 snap_to_cell(const CellSpace& space, const glm::dvec3& position);

}  // namespace farfield

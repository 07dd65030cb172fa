// SPDX-License-Identifier: Apache-2.0
// Incremental textured depth meshes of one cell.
//
// Based on: Wilson & Manocha 2003. Viewpoints as in section 3 (view_search.h), skins by its three tests (skins.h), a dependency
// tree and the removal of redundant points as in section 4.1, meshes and their simplification as in section 4.2
// (face_mesh.h), meshes drawn with projective textures and selected by a budget of scan cubes or triangles as in section 4.3
// (scan_selection.h); without one, which gives the best picture the method has, all are drawn.
//
// Differs, and why:
// - Samples are ray-cast and as dense as Farfield's (the paper: 512² per face on a display of its time); a knob.
// - Cells are Farfield's leaves, whose near region stays geometry, so that near geometry and its bytes are the same for
//   all methods. The paper's region of viewpoints and of geometry are one; it also keeps geometry exact nearest to the viewer.
// - A point is redundant if it lies on the square of a sample of an ancestor, and not only close to the sample itself: on
//   surfaces seen obliquely many more are found, as the paper's own figures of 89 to 91 % suggest. The tolerance is
//   constant in disparity, so that as a distance it grows with the square of the distance.
// - Simplification is the first of the paper's two phases with its bound of half a pixel on surfaces and outlines, for all of
//   the cell at once: the error metric works in (column, row, disparity), where it is the screen error.
// - Colours are JPEG, of delta samples only the blocks that their meshes show; the paper leaves images to other work.
#pragma once

#include "tests/bench/baselines/mesh_panel.h"
#include "tests/bench/baselines/scan_selection.h"
#include "tests/bench/baselines/view_search.h"

namespace farfield::bench {

/// Section 4.1.1: each sample's parent in the minimum spanning tree of cubed distances; the root, nearest to the centroid
/// of all, is its own. Ties go to the first.
ScanTree dependency_tree(std::vector<glm::dvec3> positions);

/// Section 4.1.2: 1 for each sample of `face` that lies on a surface some ancestor holds. `tolerance`: 1/side.
std::vector<std::uint8_t> redundant_samples(const FarFace& face, std::span<const FarView* const> ancestors, double tolerance);

struct ItdmCell {
  std::vector<MeshPanel> panels;  // not encoded yet
  FoundViews found;
  ScanTree tree;                  // kCubeFaces panels each, in its order
  std::size_t samples = 0, redundant = 0;  // covered samples of delta views, and those left out
  double intra_seconds = 0;                // casting the intra view alone
};

struct ItdmOptions {
  ViewSearch search;
  int face_samples = 0;
  double error_px = 0.5;  // of simplification (section 4.2.2)
  Display display;
  double kappa = 2;
};

/// `eye_height`: of the viewer, scene frame. Uses all TBB workers of the calling arena.
ItdmCell make_itdm(const Scene& scene, const CellSpace& space, double eye_height, const ItdmOptions& options);

/// What simplification may do for `error_px` pixels at the frame's centre from anywhere in the cell: disparity (1/side) and
/// samples across. `view`: where the samples are seen from.
struct MeshTolerance {
  double disparity = 0, outline = 0;
  static MeshTolerance of(const CellSpace& space, const ViewFrame& view, double error_px, const Display& display, double kappa);
};

}  // namespace farfield::bench

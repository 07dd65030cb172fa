// SPDX-License-Identifier: Apache-2.0
// The two oldest impostors of a cell, from one view at its centre: a flat image, and a rubber sheet.
//
// billboard. Based on: Maciel & Shirley 1995; Schaufler 1995; Aliaga 1996: what is far is a picture on a plane. Here the planes
// are the faces of one cube around the cell, as a viewer looks anywhere; all six at one distance, or seams would open
// between them off the centre. That distance is the median's of the samples (in disparity): a wrong distance moves a sample in
// proportion to its error of disparity, so the median makes the mean shift smallest, smaller than a picture at infinity's, which
// is warped by rotation only. The cube never reaches into the near region, whose surfaces lie before it.
//
// tdm. Based on: Sillion, Drettakis & Bodelet 1997; the standard TDM that Wilson & Manocha 2003 compare with (section 5.4): one
// panoramic textured depth mesh a cell, over a uniform grid, simplified, skins and all. Differs: no sheets to the sky
// (face_mesh.h), which is kinder; Sillion's choice of triangles along the image's edges is left to the simplifier's error metric.
#pragma once

#include "tests/bench/baselines/itdm.h"

namespace farfield::bench {

/// Median disparity (1/side) of a view's surfaces, limited to what keeps the cube outside the near region; 0 without any.
double billboard_disparity(const FarView& view, const CellSpace& space);
std::vector<MeshPanel> make_billboard(const FarView& view, const CellSpace& space);

/// `error_px`: of simplification.
std::vector<MeshPanel> make_depth_sheet(const FarView& view, const CellSpace& space, double error_px, const Display& display, double kappa);

}  // namespace farfield::bench

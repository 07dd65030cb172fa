// SPDX-License-Identifier: Apache-2.0
// How densely a cell must be sampled and how finely disparity must be coded (design.md section 2), in one place.
//
// Lengths are in sides of the cell, so nothing here depends on level or scene. A view stands at `view_offset` from the
// cell's centre (|component| <= 1/2); surfaces of the shell are outside the near region, so along a face's axis they
// are at least z_min = 1/2 + kappa - (offset along that axis) away.
#pragma once

#include <glm/glm.hpp>

#include "common/math/camera.h"

namespace farfield {

/// Samples along a face's edge for one sample per pixel in the worst place of the cell:
/// N = 2·(kappa + 1/2)/(kappa·p). A frontal surface at distance kappa + 1/2 from the central view is magnified most
/// when the eye comes to the cell's border, where it is kappa away; at the face's centre a sample covers 2/N.
double edge_samples_for(const Display& display, double kappa);

/// Largest angle, in radians per unit of disparity error (1/side), by which an error of disparity moves a sample as
/// seen from anywhere in the cell.
///
/// A sample in direction D0 = (u, v, 1) with disparity d lies, from an eye displaced by e, in direction D = D0 - e·d. An
/// error of d turns D at the rate |dD/dd x D|/|D|² = |e x D0|/|D|². The maximum over the cell's corners and d in [0, 1/z_min] is
/// exact; over the faces' tangent coordinates it is taken on a grid fine enough that it is within 1 % of the limit.
/// kappa = 2: 0.98 for a central view, 2.4 for one at a corner.
double warp_gain(const glm::dvec3& view_offset, double kappa);

/// The tolerance of disparity, 1/side, that keeps the warp within tau pixels at the frame's centre: tau·p/K.
double disparity_tolerance(const glm::dvec3& view_offset, double kappa, double tau_px, const Display& display);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// From a tile's samples to pixels.
//
// A sample at (u, v) with disparity d, 1/side, of a view at V is the point V + (side/d)·f, f = direction(u, v). In
// camera axes, relative to the eye E and multiplied by d/side, with R = camera_from_scene:
//     q = R·f + d·R·(V − E)/side.
// The factor is positive, so q projects to the same pixel, and d = 0 needs no special case. With p the pixel pitch:
//     X = W/2·w + q.x/p,   Y = H/2·w − q.y/p,   w = −q.z;   pixel (X/w, Y/w), eye disparity (d/side)/w per metre.
// (X, Y, w) is linear in (u, v, d): four columns per tile, made in double, used in float (error < 10⁻³ pixel).
//
// Based on: McMillan & Bishop 1995 (the warp equation). Differs: homogeneous in disparity, cube faces.
#pragma once

#include <glm/glm.hpp>

#include "client/store/leaf_view.h"
#include "common/math/camera.h"

namespace farfield::client {

struct TileProjection {
  glm::dvec3 origin{0}, per_u{0}, per_v{0}, per_disparity{0};  // (X, Y, w)
  double disparity_scale = 1;                                   // 1/side

  glm::dvec3 at(double u, double v, double disparity) const {
    return origin + u * per_u + v * per_v + disparity * per_disparity;
  }
  /// `pixels`: pixels_from_directions() of the same eye and display.
  static TileProjection of(const DecodedTile& tile, const glm::dvec3& eye, const glm::dmat3& pixels);
};

/// The linear map from directions of the scene frame to (X, Y, w): the same for all tiles of a frame.
glm::dmat3 pixels_from_directions(const glm::dquat& world_from_camera, const Display& display);

/// Where a tile's splats can land.
struct TileFootprint {
  bool is_visible = false;
  int first_row = 0, last_row = -1;        // pixel rows, inclusive, within the frame
  int first_column = 0, last_column = -1;  // columns alike
  float nearest = 0;                       // the largest eye disparity there can be
};

TileFootprint find_footprint(const TileProjection& projection, const Splats& splats, const Display& display);

}  // namespace farfield::client

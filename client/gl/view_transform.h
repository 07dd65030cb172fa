// SPDX-License-Identifier: Apache-2.0
// From the scene frame to the screen, for one frame, and what of the scene can be on the screen at all.
#pragma once

#include <glm/glm.hpp>

#include "common/math/camera.h"

namespace farfield::client {

/// A parallelepiped: centre ± the three half axes.
struct AffineBox {
  glm::dvec3 centre{0};
  glm::dmat3 half_axes{0};
};

struct ViewTransform {
  glm::dvec3 eye{0};                // scene frame
  glm::dmat3 camera_from_scene{1};  // rotation; the camera looks along its -Z
  double tan_x = 1, tan_y = 1;      // half the image in tangent units
  double near_plane_m = 0.01;

  static ViewTransform of(const Display& display, const Pose& pose, double near_plane_m) {
    const double tan_y = display.tan_half();
    return {pose.position, glm::transpose(glm::mat3_cast(pose.world_from_camera)),
            tan_y * display.width / display.height, tan_y, near_plane_m};
  }

  /// False only if no point of the box, given in camera axes relative to the eye (or in any positive multiple of
  /// that, so homogeneous points need no division), is inside the pyramid the screen spans. Conservative: a box may be
  /// reported that only comes near the pyramid's edges.
  bool may_see(const AffineBox& box) const {
    const glm::dvec3 sides[4] = {{1, 0, -tan_x}, {-1, 0, -tan_x}, {0, 1, -tan_y}, {0, -1, -tan_y}};
    for (const glm::dvec3& inward : sides) {
      const glm::dvec3 reach = glm::abs(inward * box.half_axes);
      if (glm::dot(inward, box.centre) + reach.x + reach.y + reach.z < 0) return false;
    }
    return true;
  }
};

}  // namespace farfield::client

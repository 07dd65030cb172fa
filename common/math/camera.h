// SPDX-License-Identifier: Apache-2.0
// Poses and cameras. Right-handed world; a camera looks along its -Z with +Y up.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace farfield {

/// Position in metres in the frame its user names (world or scene), rotation world-from-camera (unit length).
struct Pose {
  glm::dvec3 position{0};
  glm::dquat world_from_camera{1, 0, 0, 0};
};

/// What a frame is drawn for. Pixels are square; `fovy_rad` is the full vertical field of view.
struct Display {
  int width = 1280;
  int height = 720;
  double fovy_rad = 1.0471975511965976;  // 60 degrees

  /// Half the image height in tangent units.
  double tan_half() const { return std::tan(0.5 * fovy_rad); }
  /// Width of one pixel at the image centre in tangent units: p of design.md section 2.
  double pixel_pitch() const { return 2.0 * tan_half() / height; }
};

/// The unnormalised camera-space direction through image position (x, y) in pixels, origin top left, pixel
/// centres at +0.5; its z is -1.
inline glm::dvec3 camera_direction(const Display& display, double x, double y) {
  const double pitch = display.pixel_pitch();
  return {(x - 0.5 * display.width) * pitch, (0.5 * display.height - y) * pitch, -1.0};
}

}  // namespace farfield

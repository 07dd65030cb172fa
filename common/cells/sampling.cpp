// SPDX-License-Identifier: Apache-2.0
#include "common/cells/sampling.h"

#include <algorithm>

#include "common/math/cube_face.h"

namespace farfield {
namespace {

// Largest |e x D0| / |D0 - e·d|² over the face, with the eye displaced by `eye`.
double face_gain(int face, const glm::dvec3& eye, double nearest) {
  constexpr int kSteps = 16;
  const CubeFace frame = CubeFace::of(face);
  double worst = 0;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) {
      const glm::dvec3 direction = frame.direction(2.0 * i / kSteps - 1, 2.0 * j / kSteps - 1);
      // Of all depths in this direction, the one whose point comes nearest to the eye.
      const double squared = glm::dot(eye, eye), at = squared > 0 ? std::clamp(glm::dot(direction, eye) / squared, 0.0, 1 / nearest) : 0;
      const glm::dvec3 seen = direction - eye * at;
      worst = std::max(worst, glm::length(glm::cross(eye, direction)) / glm::dot(seen, seen));
    }
  return worst;
}

}  // namespace

double edge_samples_for(const Display& display, double kappa) {
  return 2.0 * (kappa + 0.5) / (kappa * display.pixel_pitch());
}

double warp_gain(const glm::dvec3& view_offset, double kappa) {
  double worst = 0;
  for (int face = 0; face < kCubeFaces; ++face) {
    const CubeFace frame = CubeFace::of(face);
    const double nearest = 0.5 + kappa - frame.sign * view_offset[frame.axis];
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 eye{corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5};
      worst = std::max(worst, face_gain(face, eye - view_offset, nearest));
    }
  }
  return worst;
}

double disparity_tolerance(const glm::dvec3& view_offset, double kappa, double tau_px, const Display& display) {
  return tau_px * display.pixel_pitch() / warp_gain(view_offset, kappa);
}

}  // namespace farfield

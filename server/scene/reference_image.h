// SPDX-License-Identifier: Apache-2.0
// The scene ray-cast directly from a viewpoint: truth at 16 samples per pixel, the method "rays" at one or more.
#pragma once

#include <vector>

#include "common/math/camera.h"
#include "server/scene/scene.h"

namespace farfield {

struct ReferenceImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;            // sRGB, rows top to bottom
  std::vector<float> disparity;             // 1/(z along the camera's axis) of the sample nearest the pixel's centre, 1/m
  std::vector<std::uint8_t> has_surface;    // 1: more than half of the pixel's samples hit a surface; ties, an
                                            // eighth of all outlines along an axis, say nothing about its centre
};

/// `eye` in the scene frame. Samples lie on a regular grid in the pixel (1: the pixel's centre; 4: 2×2; 16: 4×4) and are averaged
/// in linear light. Uses all TBB workers of the calling arena. Requires: samples_per_pixel is 1, 4 or 16.
ReferenceImage render_reference(const Scene& scene, const Pose& eye, const Display& display, int samples_per_pixel);

}  // namespace farfield

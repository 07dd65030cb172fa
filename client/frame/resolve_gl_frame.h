// SPDX-License-Identifier: Apache-2.0
// From what OpenGL drew to a finished frame: coverage classes, cracks and voids, the background behind silhouettes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "client/warp/frame_image.h"
#include "common/impostor/direction_mask.h"

namespace farfield::client {

struct GlImage {
  int width = 0, height = 0;
  std::span<const std::uint8_t> rgba;  // sRGB over black; alpha: kNearAlpha, kImpostorAlpha or 0 per sample, averaged
  std::span<const float> depth;        // near_plane / z, of one of the pixel's samples; 0: nothing
  double near_plane_m = 0.01;
};

struct GlResolveOptions {
  glm::u8vec3 background{0};  // sRGB
  SkyTest sky;                // where a pixel that nothing covers may be sky
  int void_radius = 8;        // pixels within which surfaces enclose a void
};

/// Writes `frame` and its crack, void and background counts. A pixel of which only some samples are covered shows the
/// covered ones over what a void there would show, mixed in linear light; it counts as covered.
void resolve_gl_frame(const GlImage& image, const GlResolveOptions& options, Frame& frame);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// What a depth buffer holds, everywhere in the client: near_plane / z, z the distance along the camera's axis.
// 1 at the near plane, 0 at infinity (reversed, without a far plane); a fragment wins when its value is GREATER.
// Disparity is the same number divided by near_plane, so near geometry, impostors and the CPU warper meet exactly.
//
// With clip z in [0, 1] the vertex shader writes clip.z = near_plane and the division by w = z does the rest, in a
// float's full relative precision at any distance. Without that ability clip.z = 2·near_plane - w gives the same
// window depth, accurate to 2⁻²⁴ of the range: shaders write clip.z = depth_scale·near_plane - depth_bias·w.
#pragma once

#include "client/gl/gl_context.h"

namespace farfield::client {

struct DepthConvention {
  float scale = 2, bias = 1;

  static DepthConvention of(const GlAbilities& abilities) {
    return abilities.has_clip_control ? DepthConvention{1, 0} : DepthConvention{2, 1};
  }
};

/// Sets clip control, depth test and face culling (none: surfaces are two-sided) for drawing scene geometry.
void begin_scene_drawing(const GlAbilities& abilities);

}  // namespace farfield::client

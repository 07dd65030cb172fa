// SPDX-License-Identifier: Apache-2.0
#include "client/gl/depth_convention.h"

#include <epoxy/gl.h>

namespace farfield::client {

void begin_scene_drawing(const GlAbilities& abilities) {
  if (abilities.has_clip_control) {
    if (abilities.is_embedded) {
      glClipControlEXT(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    } else {
      glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    }
  }
  if (!abilities.is_embedded) glEnable(GL_FRAMEBUFFER_SRGB);  // always on in OpenGL ES
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/gl/gl_handle.h"

#include <epoxy/gl.h>

namespace farfield::client {

void delete_gl_object(GlKind kind, GlName name) {
  switch (kind) {
    case GlKind::kBuffer: glDeleteBuffers(1, &name); break;
    case GlKind::kVertexArray: glDeleteVertexArrays(1, &name); break;
    case GlKind::kTexture: glDeleteTextures(1, &name); break;
    case GlKind::kRenderbuffer: glDeleteRenderbuffers(1, &name); break;
    case GlKind::kFramebuffer: glDeleteFramebuffers(1, &name); break;
    case GlKind::kProgram: glDeleteProgram(name); break;
    case GlKind::kShader: glDeleteShader(name); break;
  }
}

GlName make_gl_object(GlKind kind) {
  GlName name = 0;
  switch (kind) {
    case GlKind::kBuffer: glGenBuffers(1, &name); break;
    case GlKind::kVertexArray: glGenVertexArrays(1, &name); break;
    case GlKind::kTexture: glGenTextures(1, &name); break;
    case GlKind::kRenderbuffer: glGenRenderbuffers(1, &name); break;
    case GlKind::kFramebuffer: glGenFramebuffers(1, &name); break;
    case GlKind::kProgram:
    case GlKind::kShader: break;  // made by Program, which knows their stage
  }
  return name;
}

}  // namespace farfield::client

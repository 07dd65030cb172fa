// SPDX-License-Identifier: Apache-2.0
// An OpenGL context: without any window (surfaceless EGL, also where there is no GPU and no X server), or the one a
// window front has made current. Renderers keep to OpenGL ES 3.0; what goes beyond is used where the context has it.
//
// Thread rule of everything in client/gl, client/near and client/warp_gl: a context and all objects made in it belong
// to one thread, the one it is current on.
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"

namespace farfield::client {

/// What the context offers beyond OpenGL ES 3.0.
struct GlAbilities {
  bool is_software = false;       // no GPU: Mesa's llvmpipe, softpipe or another program that names itself software
  bool is_embedded = true;        // OpenGL ES rather than desktop OpenGL
  bool has_clip_control = false;  // clip z in [0, 1]: distant depths keep a float's full precision
  bool has_multi_draw = false;
  bool can_read_depth = false;  // glReadPixels of depth
  int max_samples = 0;
  int max_texture_layers = 0;
  int max_texture_edge = 0;
  std::string renderer, version;
};

class GlContext {
 public:
  /// A context of its own, current on the calling thread when this returns. No display server is needed.
  /// Errors: kUnavailable, with what the driver lacks.
  static Result<std::unique_ptr<GlContext>> create_surfaceless();
  /// Wraps the context that is current now (a GLFW window's); its owner destroys it after this object.
  /// Errors: kUnavailable: none is current, or it is older than OpenGL ES 3.0 / OpenGL 3.3.
  static Result<std::unique_ptr<GlContext>> adopt_current();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Moves a surfaceless context to the calling thread. Requires: current on no other thread.
  Status make_current();
  /// Releases a surfaceless context from the calling thread, so that another may take it.
  void release_current();
  const GlAbilities& abilities() const { return abilities_; }

 private:
  GlContext() = default;
  Status read_abilities();

  void* display_ = nullptr;  // EGLDisplay; null: adopted
  void* context_ = nullptr;  // EGLContext
  GlAbilities abilities_;
};

}  // namespace farfield::client

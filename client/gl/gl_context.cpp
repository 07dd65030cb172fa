// SPDX-License-Identifier: Apache-2.0
#include "client/gl/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

namespace farfield::client {
namespace {

EGLDisplay surfaceless_display() {
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") &&
      epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  }
  return eglGetDisplay(EGL_DEFAULT_DISPLAY);
}

EGLContext create_context(EGLDisplay display, EGLenum api) {
  if (eglBindAPI(api) != EGL_TRUE) return EGL_NO_CONTEXT;
  const EGLint embedded[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
  // 4.3 is the first desktop version that must compile "#version 300 es".
  const EGLint desktop[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, api == EGL_OPENGL_ES_API ? embedded : desktop);
}

}  // namespace

Result<std::unique_ptr<GlContext>> GlContext::create_surfaceless() {
  const EGLDisplay display = surfaceless_display();
  EGLint major = 0, minor = 0;
  if (display == EGL_NO_DISPLAY || eglInitialize(display, &major, &minor) != EGL_TRUE) {
    return fail(ErrorCode::kUnavailable,
                "OpenGL without a window: no EGL display could be opened; install Mesa's EGL (libegl-mesa0, "
                "libgl1-mesa-dri) or set EGL_PLATFORM");
  }
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") ||
      !epoxy_has_egl_extension(display, "EGL_KHR_no_config_context")) {
    return fail(ErrorCode::kUnavailable,
                "OpenGL without a window: EGL {}.{} ({}) cannot make a context without a surface; use Mesa's driver",
                major, minor, eglQueryString(display, EGL_VENDOR));
  }
  EGLContext context = create_context(display, EGL_OPENGL_ES_API);
  if (context == EGL_NO_CONTEXT) context = create_context(display, EGL_OPENGL_API);
  if (context == EGL_NO_CONTEXT) {
    return fail(ErrorCode::kUnavailable,
                "OpenGL without a window: EGL {}.{} offers neither OpenGL ES 3.0 nor OpenGL 4.3 (EGL error {:#x}); "
                "update the driver",
                major, minor, static_cast<unsigned>(eglGetError()));
  }
  std::unique_ptr<GlContext> result(new GlContext);
  result->display_ = display;
  result->context_ = context;
  if (Status current = result->make_current(); !current) return tl::unexpected<Error>(current.error());
  if (Status read = result->read_abilities(); !read) return tl::unexpected<Error>(read.error());
  return result;
}

Result<std::unique_ptr<GlContext>> GlContext::adopt_current() {
  std::unique_ptr<GlContext> result(new GlContext);
  // glXGetCurrentContext would need GLX; a context of either kind answers this.
  if (eglGetCurrentContext() == EGL_NO_CONTEXT) {
    return fail(ErrorCode::kUnavailable,
                "OpenGL: no EGL context is current on this thread; make the window's context current first");
  }
  if (Status read = result->read_abilities(); !read) return tl::unexpected<Error>(read.error());
  return result;
}

GlContext::~GlContext() {
  if (display_ == nullptr) return;
  release_current();
  eglDestroyContext(display_, context_);
  // The display is shared by every context of the process: it is left to the process's end.
}

Status GlContext::make_current() {
  if (display_ == nullptr || eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE) return {};
  return fail(ErrorCode::kUnavailable,
              "OpenGL without a window: the context could not be made current (EGL error {:#x}); is it current on "
              "another thread?",
              static_cast<unsigned>(eglGetError()));
}

void GlContext::release_current() {
  if (display_ != nullptr && eglGetCurrentContext() == context_) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
}

Status GlContext::read_abilities() {
  const auto text = [](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(glGetString(name));
    return std::string(value ? value : "unknown");
  };
  abilities_.renderer = text(GL_RENDERER);
  abilities_.version = text(GL_VERSION);
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software"}) {
    if (abilities_.renderer.find(name) != std::string::npos) abilities_.is_software = true;
  }
  abilities_.is_embedded = !epoxy_is_desktop_gl();
  const int version = epoxy_gl_version();
  if (version < (abilities_.is_embedded ? 30 : 33) ||
      (!abilities_.is_embedded && version < 43 && !epoxy_has_gl_extension("GL_ARB_ES3_compatibility"))) {
    return fail(ErrorCode::kUnavailable, "OpenGL: {} on {} is too old; OpenGL ES 3.0 is needed", abilities_.version,
                abilities_.renderer);
  }
  abilities_.has_clip_control = abilities_.is_embedded ? epoxy_has_gl_extension("GL_EXT_clip_control")
                                                       : version >= 45 || epoxy_has_gl_extension("GL_ARB_clip_control");
  abilities_.has_multi_draw = !abilities_.is_embedded || epoxy_has_gl_extension("GL_EXT_multi_draw_arrays");
  abilities_.can_read_depth = !abilities_.is_embedded || epoxy_has_gl_extension("GL_NV_read_depth");
  glGetIntegerv(GL_MAX_SAMPLES, &abilities_.max_samples);
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &abilities_.max_texture_layers);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &abilities_.max_texture_edge);
  return {};
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/input/window.h"

#include <epoxy/gl.h>
// After epoxy, which declares OpenGL itself.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

#include "client/gl/gl_handle.h"
#include "client/gl/program.h"

namespace farfield::client {
namespace {

constexpr const char* kVertex = R"(#version 300 es
out vec2 place;
void main() {
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  place = vec2(corner.x, 1.0 - corner.y);  // frames have their top row first
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
)";
constexpr const char* kFragment = R"(#version 300 es
precision highp float;
uniform sampler2D frame;
in vec2 place;
layout(location = 0) out vec4 colour;
void main() { colour = texture(frame, place); }
)";

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "GLFW gave no reason";
}

double key_axis(GLFWwindow* window, int positive, int negative) {
  return (glfwGetKey(window, positive) == GLFW_PRESS ? 1.0 : 0.0) -
         (glfwGetKey(window, negative) == GLFW_PRESS ? 1.0 : 0.0);
}

}  // namespace

struct Window::State {
  bool is_initialised = false;
  GLFWwindow* window = nullptr;
  WindowEvents events;  // gathered by callbacks since the last poll
  double cursor_x = 0, cursor_y = 0;
  bool is_looking = false;
  std::unique_ptr<GlContext> context;
  Program program;
  TextureName texture;
  VertexArrayName no_attributes;
  int texture_width = 0, texture_height = 0;

  ~State() {
    program = {}, texture = {}, no_attributes = {};
    context.reset();
    if (window) glfwDestroyWindow(window);
    if (is_initialised) glfwTerminate();
  }
  void set_callbacks();
  void look();
};

// GLFW calls C functions; the window's user pointer leads back here.
void Window::State::set_callbacks() {
  glfwSetWindowUserPointer(window, this);
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double steps) {
    static_cast<State*>(glfwGetWindowUserPointer(w))->events.move.wheel_steps += steps;
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    WindowEvents& events = static_cast<State*>(glfwGetWindowUserPointer(w))->events;
    if (key == GLFW_KEY_ESCAPE) events.quit = true;
    if (key == GLFW_KEY_R) events.toggle_recording = true;
    if (key == GLFW_KEY_F) events.toggle_flying = true;
  });
}

/// The mouse turns the view while a button is held.
void Window::State::look() {
  double x = 0, y = 0;
  glfwGetCursorPos(window, &x, &y);
  const bool is_held = glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS ||
                       glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
  if (is_held && is_looking) {
    events.move.look_right_px = x - cursor_x;
    events.move.look_down_px = y - cursor_y;
  }
  is_looking = is_held;
  cursor_x = x, cursor_y = y;
}

Window::Window() : state_(std::make_unique<State>()) {}
Window::~Window() = default;

Result<std::unique_ptr<Window>> Window::open(int width, int height, const std::string& title, bool wait_for_vsync) {
  std::unique_ptr<Window> result(new Window);
  State& s = *result->state_;
  if (glfwInit() != GLFW_TRUE) {
    return fail(ErrorCode::kUnavailable, "window: {}; set DISPLAY, or run without a window", last_glfw_error());
  }
  s.is_initialised = true;
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
  s.window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!s.window) {
    return fail(ErrorCode::kUnavailable, "window of {} x {}: {}; OpenGL ES 3.0 through EGL is needed", width, height,
                last_glfw_error());
  }
  glfwMakeContextCurrent(s.window);
  glfwSwapInterval(wait_for_vsync ? 1 : 0);
  Result<std::unique_ptr<GlContext>> context = GlContext::adopt_current();
  if (!context) return fail_within("window", context.error());
  s.context = std::move(*context);
  Result<Program> program = Program::build("window", kVertex, kFragment);
  if (!program) return tl::unexpected<Error>(program.error());
  s.program = std::move(*program);
  s.no_attributes = VertexArrayName::make();
  s.set_callbacks();
  return result;
}

WindowEvents Window::poll() {
  State& s = *state_;
  if (width() == 0 || height() == 0) {
    glfwWaitEventsTimeout(0.05);
  } else {
    glfwPollEvents();
  }
  s.look();
  s.events.move.forward = key_axis(s.window, GLFW_KEY_W, GLFW_KEY_S);
  s.events.move.right = key_axis(s.window, GLFW_KEY_D, GLFW_KEY_A);
  s.events.move.up = key_axis(s.window, GLFW_KEY_E, GLFW_KEY_Q);
  s.events.move.is_fast = glfwGetKey(s.window, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS;
  s.events.quit |= glfwWindowShouldClose(s.window) == GLFW_TRUE;
  return std::exchange(s.events, {});
}

void Window::show(const Frame& frame) {
  State& s = *state_;
  glActiveTexture(GL_TEXTURE0);
  if (frame.width != s.texture_width || frame.height != s.texture_height) {
    s.texture = TextureName::make();
    glBindTexture(GL_TEXTURE_2D, s.texture.name());
    // Not sRGB: the frame is coded already and the window takes it as it is.
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, frame.width, frame.height);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    s.texture_width = frame.width, s.texture_height = frame.height;
  }
  glBindTexture(GL_TEXTURE_2D, s.texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, frame.width, frame.height, GL_RGBA, GL_UNSIGNED_BYTE, frame.rgba.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width(), height());
  glDisable(GL_DEPTH_TEST);
  s.program.use();
  glBindVertexArray(s.no_attributes.name());
  // Two triangles over the window.
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glfwSwapBuffers(s.window);
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(state_->window, title.c_str());
}

int Window::width() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(state_->window, &width, &height);
  return width;
}

int Window::height() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(state_->window, &width, &height);
  return height;
}

GlContext& Window::context() {
  return *state_->context;
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// One window with an OpenGL ES 3 context: opening it, showing frames in it, reading keys and mouse.
// Main thread only (GLFW's rule). One window at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "client/gl/gl_context.h"
#include "client/input/walk_camera.h"
#include "client/warp/frame_image.h"
#include "common/base/result.h"

namespace farfield::client {

/// What happened since the last poll.
struct WindowEvents {
  MoveInput move;
  bool quit = false;
  bool toggle_recording = false;
  bool toggle_flying = false;
};

class Window {
 public:
  /// Errors: kUnavailable: no display server, or no OpenGL ES 3.
  static Result<std::unique_ptr<Window>> open(int width, int height, const std::string& title, bool wait_for_vsync);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Never blocks, except while the window is minimised: then for at most 50 ms.
  WindowEvents poll();
  /// Stretches the frame over the window and swaps buffers.
  void show(const Frame& frame);
  void set_title(const std::string& title);

  /// Size of the drawing area in pixels, 0 × 0 while minimised.
  int width() const;
  int height() const;
  GlContext& context();

 private:
  Window();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// The interactive front: a loop that moves a viewer, asks a source what to draw, draws it, and shows it.
//
// W A S D move, E and Q up and down, mouse with a button held looks, wheel changes the speed, Shift is fast, F switches
// between walking and flying, R starts and stops recording a trace, Esc quits. Frame statistics stand in the title.
// Main thread only.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/frame/frame_renderer.h"
#include "client/store/leaf_view.h"
#include "common/trace/trace.h"

namespace farfield::client {

class ClientCore;

/// Where the window gets what it draws. Scene frame throughout; called from the window's thread, must not block.
struct WindowSource {
  std::function<std::shared_ptr<const LeafView>()> view;  // may return null
  std::function<void(const Pose& pose, double time_s)> set_pose;
  std::function<bool(const LeafView* drawn, const glm::dvec3& eye)> count_frame;  // was it late? may be empty
  std::function<std::string()> status;  // a few words for the title; may be empty
};
/// `core` must outlive the source.
WindowSource window_source(ClientCore& core);

struct WindowOptions {
  Renderer renderer = Renderer::kCpu;
  Display display;  // the window may be resized later; the field of view stays
  FrameOptions frame;
  Pose start;            // scene frame
  glm::dvec3 origin{0};  // world position of the scene frame's zero: traces are in the world frame
  std::string scene;     // name for the title and for recorded traces
  double speed_m_s = 1.4;
  std::string record_path = "walk.trace";
  bool records_from_start = false;
  std::optional<Trace> replay;  // moves the viewer instead of the keys, in real time, then ends the loop
  bool wait_for_vsync = true;
  std::uint64_t most_frames = 0;  // 0: until the viewer quits
};

struct WindowSummary {
  std::uint64_t frames = 0, late_frames = 0;
  double seconds = 0;
  double median_frame_ms = 0, p99_frame_ms = 0;  // from the pose to the finished image
  std::vector<std::string> recorded;             // traces written
};

/// Returns when the viewer quits, the replay ends or `most_frames` were drawn.
/// Errors: kUnavailable (no display server or OpenGL), kIo (a trace cannot be written), those of FrameRenderer.
Result<WindowSummary> run_window(const WindowSource& source, const WindowOptions& options);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "client/input/run_window.h"

#include <chrono>
#include <cmath>

#include "client/input/frame_clock.h"
#include "client/input/walk_camera.h"
#include "client/input/window.h"
#include "client/session/client_core.h"
#include "common/trace/trace_file.h"

namespace farfield::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTitleSeconds = 0.25;
// A step longer than this (the window was dragged, the machine slept) would fling the viewer across the scene.
constexpr double kLongestStepSeconds = 0.1;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Records poses between two presses of R; each recording gets a file of its own.
class Recorder {
 public:
  explicit Recorder(const WindowOptions& options) : options_(options) {}

  bool is_recording() const { return is_recording_; }
  void start() {
    is_recording_ = true;
    trace_ = {};
    trace_.scene = options_.scene;
  }
  void add(double time_s, const Pose& scene_pose) {
    if (!is_recording_ || (!trace_.frames.empty() && time_s <= trace_.frames.back().time_s)) return;
    trace_.frames.push_back({time_s, {scene_pose.position + options_.origin, scene_pose.world_from_camera}});
  }
  /// Writes what was recorded, if anything.
  Status stop() {
    if (!std::exchange(is_recording_, false) || trace_.frames.empty()) return {};
    const double begin = trace_.frames.front().time_s;
    for (TraceFrame& frame : trace_.frames) frame.time_s -= begin;
    const std::string path =
        written_.empty() ? options_.record_path : fmt::format("{}.{}", options_.record_path, written_.size() + 1);
    if (Status status = write_trace(path, trace_); !status) return status;
    written_.push_back(path);
    return {};
  }
  const std::vector<std::string>& written() const { return written_; }

 private:
  const WindowOptions& options_;
  bool is_recording_ = false;
  Trace trace_;
  std::vector<std::string> written_;
};

std::string title_line(const WindowOptions& options, const FrameReport& report, const Frame& frame, double speed_m_s,
                       const FramePromise& promise, bool is_recording, const std::string& status) {
  const std::string promised = std::isfinite(promise.psnr_db) && std::isfinite(promise.void_share)
                                   ? fmt::format(" (promised {:.3f} %, {:.1f} dB, {:.2f} px)", 100 * promise.void_share, promise.psnr_db, promise.warp_px)
                                   : std::string();
  return fmt::format("Farfield {} | {:.1f} ms | near {} triangles | impostors {} | void {} px{} | {:.2g} m/s{}{}{}",
                     options.scene, report.times.total_ms, report.near.triangles,
                     options.renderer == Renderer::kGl ? fmt::format("{} triangles", frame.statistics.triangles_drawn)
                                                       : fmt::format("{} samples", frame.statistics.samples_drawn),
                     frame.statistics.void_pixels, promised, speed_m_s, is_recording ? " | recording" : "",
                     status.empty() ? "" : " | ", status);
}

/// Everything one run of the window holds.
class WindowLoop {
 public:
  WindowLoop(const WindowSource& source, const WindowOptions& options, Window& window, FrameRenderer& renderer)
      : source_(source),
        options_(options),
        window_(window),
        renderer_(renderer),
        camera_(options.start, options.speed_m_s),
        recorder_(options) {}

  Result<WindowSummary> run();

 private:
  Status handle(const WindowEvents& events);
  Status follow_size();
  bool is_over(double time_s) const;
  Pose next_pose(const WindowEvents& events, double time_s);

  const WindowSource& source_;
  const WindowOptions& options_;
  Window& window_;
  FrameRenderer& renderer_;
  WalkCamera camera_;
  Recorder recorder_;
  FrameClock clock_;
  WindowSummary summary_;
  double last_time_s_ = 0;
};

Status WindowLoop::handle(const WindowEvents& events) {
  if (events.toggle_flying) camera_.toggle_flying();
  if (!events.toggle_recording) return {};
  if (recorder_.is_recording()) return recorder_.stop();
  recorder_.start();
  return {};
}

Status WindowLoop::follow_size() {
  const Display& now = renderer_.display();
  const int width = window_.width(), height = window_.height();
  if (width == 0 || height == 0 || (width == now.width && height == now.height)) return {};
  return renderer_.resize({width, height, now.fovy_rad});
}

bool WindowLoop::is_over(double time_s) const {
  if (options_.most_frames > 0 && clock_.frames() >= options_.most_frames) return true;
  return options_.replay && time_s > options_.replay->seconds();
}

Pose WindowLoop::next_pose(const WindowEvents& events, double time_s) {
  const double step = std::min(time_s - last_time_s_, kLongestStepSeconds);
  last_time_s_ = time_s;
  if (options_.replay && !options_.replay->frames.empty()) {
    Pose pose = pose_at(*options_.replay, options_.replay->frames.front().time_s + time_s);
    pose.position -= options_.origin;
    return pose;
  }
  camera_.advance(events.move, step);
  return camera_.pose();
}

Result<WindowSummary> WindowLoop::run() {
  const Clock::time_point start = Clock::now();
  if (options_.records_from_start) recorder_.start();
  double title_time_s = -kTitleSeconds;
  Frame frame;
  for (;;) {
    const WindowEvents events = window_.poll();
    const double time_s = seconds_since(start);
    if (events.quit || is_over(time_s)) break;
    if (Status status = handle(events); !status) return tl::unexpected<Error>(status.error());
    if (Status status = follow_size(); !status) return tl::unexpected<Error>(status.error());
    const Pose pose = next_pose(events, time_s);
    recorder_.add(time_s, pose);
    source_.set_pose(pose, time_s);
    if (window_.width() == 0 || window_.height() == 0) continue;  // minimised: nothing to show
    const FrameReport report = renderer_.render(source_.view(), pose, frame, time_s);
    window_.show(frame);
    clock_.add(report.times.total_ms);
    if (source_.count_frame && source_.count_frame(report.drawn.get(), pose.position)) ++summary_.late_frames;
    if (time_s - title_time_s >= kTitleSeconds) {
      title_time_s = time_s;
      window_.set_title(title_line(options_, report, frame, camera_.speed_m_s(),
                                   report.drawn ? renderer_.promise(*report.drawn, pose) : FramePromise(), recorder_.is_recording(),
                                   source_.status ? source_.status() : ""));
    }
  }
  if (Status status = recorder_.stop(); !status) return tl::unexpected<Error>(status.error());
  summary_.frames = clock_.frames();
  summary_.seconds = seconds_since(start);
  summary_.median_frame_ms = clock_.quantile_ms(0.5);
  summary_.p99_frame_ms = clock_.quantile_ms(0.99);
  summary_.recorded = recorder_.written();
  return summary_;
}

}  // namespace

WindowSource window_source(ClientCore& core) {
  return {[&core] { return core.view(); }, [&core](const Pose& pose, double time_s) { core.set_pose(pose, time_s); },
          [&core](const LeafView* drawn, const glm::dvec3& eye) { return core.count_frame(drawn, eye); },
          [&core]() -> std::string {
            const ClientStatus status = core.status();
            return status.state == ClientState::kStreaming ? "" : client_state_name(status.state);
          }};
}

Result<WindowSummary> run_window(const WindowSource& source, const WindowOptions& options) {
  Result<std::unique_ptr<Window>> window =
      Window::open(options.display.width, options.display.height, "Farfield " + options.scene, options.wait_for_vsync);
  if (!window) return tl::unexpected<Error>(window.error());
  Result<std::unique_ptr<FrameRenderer>> renderer =
      FrameRenderer::create(options.renderer, options.display, options.frame, &(*window)->context());
  if (!renderer) return tl::unexpected<Error>(renderer.error());
  return WindowLoop(source, options, **window, **renderer).run();
}

}  // namespace farfield::client

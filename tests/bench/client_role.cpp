// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/client_role.h"

#include <sys/prctl.h>

#include <csignal>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "client/frame/frame_renderer.h"
#include "client/session/client_core.h"
#include "common/base/one_line.h"
#include "common/trace/trace_file.h"
#include "tests/bench/client_process.h"
#include "tests/bench/frame_dump.h"
#include "tests/bench/promises.h"

namespace farfield::bench {
namespace {

using client::ClientCore;
using client::FrameRenderer;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Walk {
  nlohmann::json frame_ms = nlohmann::json::array();
  nlohmann::json promises = nlohmann::json::array();  // of each frame drawn
  nlohmann::json triangles = nlohmann::json::array(), samples = nlohmann::json::array();
  std::uint64_t frames = 0, late = 0, blank = 0;
  double seconds = 0;
  double entry_seconds = 0;
};

class Walker {
 public:
  Walker(const ClientRole& role, const Trace& trace, ClientCore& core, FrameRenderer& renderer, const client::SceneDescription& scene)
      : role_(role), trace_(trace), core_(core), renderer_(renderer), scene_(scene) {}

  // Every frame waits for its complete leaf set, and so does every leaf on the way from one to the next: what is received is
  // what the whole walk needs, however few of its frames are looked at. Each is drawn twice and the second drawing counts, so that first uses
  // of shaders and buffers (paid once, not per frame) stay out of the figure.
  Result<Walk> lockstep() {
    Walk walk;
    const Result<Trace> sampled = resampled(trace_, std::min(role_.frames, trace_.frames.size()));
    if (!sampled) return tl::unexpected(sampled.error());
    const Clock::time_point start = Clock::now();
    std::size_t next = 0;  // frame of the trace
    for (std::size_t k = 0; k < sampled->frames.size(); ++k) {
      for (; k > 0 && next < trace_.frames.size() && trace_.frames[next].time_s < sampled->frames[k].time_s; ++next)
        if (Status status = walk_through(trace_.frames[next].pose, start); !status) return tl::unexpected(status.error());
      const Pose eye = scene_.scene_from_world(sampled->frames[k].pose);
      core_.set_pose(eye, seconds_since(start));
      const auto view = core_.wait_complete(eye.position, std::chrono::minutes(5));
      if (!view) return tl::unexpected(view.error());
      if (k == 0) walk.entry_seconds = seconds_since(start);
      client::Frame frame;
      wait_for_quiet();
      const double time_s = sampled->frames[k].time_s;
      renderer_.render(*view, eye, frame, time_s);
      const client::FrameReport report = renderer_.render(*view, eye, frame, time_s);
      std::cout << kGoOn << std::endl;
      core_.count_frame(view->get(), eye.position);
      shown_ = *view;
      record(walk, report, frame);
      walk.promises.push_back(bench::to_json(renderer_.promise(**view, eye)));
      if (Status status = write_frame(frame_path(role_.folder, k), sampled->frames[k].pose, frame); !status) return tl::unexpected(status.error());
    }
    walk.seconds = seconds_since(start);
    return walk;
  }

  // The trace's clock runs; it starts when something is on the screen, as a viewer's walk does.
  Result<Walk> realtime() {
    Walk walk;
    const Pose first = scene_.scene_from_world(trace_.frames.front().pose);
    const Clock::time_point begin = Clock::now();
    while (!core_.view() && seconds_since(begin) < 60) {
      core_.set_pose(first, -60 + seconds_since(begin));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    client::Frame frame;
    if (core_.view()) renderer_.render(core_.view(), first, frame);
    const Clock::time_point start = Clock::now();
    const double length = trace_.seconds();
    std::size_t dumped = 0;
    const std::size_t wanted = std::min(role_.frames, trace_.frames.size());
    for (double now = 0; now < length; now = seconds_since(start)) {
      const Pose world = pose_at(trace_, trace_.frames.front().time_s + now);
      const Pose eye = scene_.scene_from_world(world);
      core_.set_pose(eye, now);
      const std::shared_ptr<const client::LeafView> view = core_.view();
      const client::FrameReport report = renderer_.render(view, eye, frame, now);
      core_.count_frame(report.drawn.get(), eye.position);
      record(walk, report, frame);
      walk.blank += report.drawn == nullptr;
      if (dumped < wanted && now >= length * (static_cast<double>(dumped) + 0.5) / static_cast<double>(wanted)) {
        if (Status status = write_frame(frame_path(role_.folder, dumped), world, frame); !status) return tl::unexpected(status.error());
        ++dumped;
      }
      // A display of 60 frames a second shows no more than that.
      const double next = now + 1.0 / 60;
      if (const double rest = next - seconds_since(start); rest > 0) std::this_thread::sleep_for(std::chrono::duration<double>(rest));
    }
    walk.seconds = seconds_since(start);
    walk.entry_seconds = core_.statistics().entry_seconds;
    return walk;
  }

 private:
  // Waits for the leaf set there, if that is not the last one.
  Status walk_through(const Pose& pose, Clock::time_point start) {
    const Pose eye = scene_.scene_from_world(pose);
    if (shown_ && shown_->speaks_for(eye.position)) return {};
    core_.set_pose(eye, seconds_since(start));
    const auto view = core_.wait_complete(eye.position, std::chrono::minutes(5));
    if (!view) return tl::unexpected(view.error());
    shown_ = *view;
    return {};
  }
  /// The server begins nothing more; what was on its way is given the time of a few frames to arrive and be decoded.
  void wait_for_quiet() {
    std::cout << kQuiet << std::endl;
    for (std::string line; std::getline(std::cin, line) && line != kIsQuiet;) {
    }
    std::uint64_t seen = 0;
    for (int glances = 0; glances < 100 && core_.statistics().bytes_in != std::exchange(seen, core_.statistics().bytes_in); ++glances)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }

  static void record(Walk& walk, const client::FrameReport& report, const client::Frame& frame) {
    walk.frame_ms.push_back(report.times.total_ms);
    walk.triangles.push_back(report.near.triangles + frame.statistics.triangles_drawn);
    walk.samples.push_back(frame.statistics.samples_drawn);
    ++walk.frames;
  }

  const ClientRole& role_;
  const Trace& trace_;
  ClientCore& core_;
  FrameRenderer& renderer_;
  const client::SceneDescription& scene_;
  std::shared_ptr<const client::LeafView> shown_;
};

// The high-water mark of this program alone: getrusage() would also count what the parent held before the exec.
double peak_resident_mb() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  return std::nan("");
}

nlohmann::json to_json(const Walk& walk, const client::ClientStatistics& s) {
  return {{"frame_ms", walk.frame_ms},
          {"triangles", walk.triangles},
          {"samples", walk.samples},
          {"promises", walk.promises},
          {"frames", walk.frames},
          {"blank", walk.blank},
          {"seconds", walk.seconds},
          {"entry_seconds", walk.entry_seconds},
          {"late_share", s.frames ? static_cast<double>(s.late_frames) / static_cast<double>(s.frames) : 0.0},
          {"fallback_frames", s.fallback_frames},
          {"bytes_in", s.bytes_in},
          {"bytes_out", s.bytes_out},
          {"entry_bytes", s.entry_bytes},
          {"colour", s.tile_colour_bytes},
          {"disparity", s.tile_disparity_bytes},
          {"tile_other", s.tile_other_bytes},
          {"near_geometry", s.chunk_bytes},
          {"textures", s.texture_bytes},
          {"control", s.control_bytes},
          {"redundant", s.redundant_payloads},
          {"bad", s.bad_payloads},
          {"leaf_sets", s.switches},
          {"decode_seconds", s.decode_seconds},
          {"peak_rss_mb", peak_resident_mb()}};
}

}  // namespace

int run_client_role(const ClientRole& role) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // it never outlives the measurement
  const auto complain = [](const Error& error) {
    std::cout << kFailed << one_line(error.message) << std::endl;  // farfield-bench says it, in its own one line
    return 1;
  };
  const Result<Trace> trace = read_trace(role.trace);
  if (!trace) return complain(trace.error());
  if (trace->frames.empty()) return complain({ErrorCode::kInvalidArgument, "the trace holds no pose"});
  const Result<Endpoint> endpoint = parse_endpoint(role.endpoint);
  if (!endpoint) return complain(endpoint.error());
  client::ClientOptions options;
  options.server = *endpoint;
  options.program = "farfield-bench";
  options.display = role.display;
  options.use_fallback = role.mode != "lockstep";  // where every frame waits for its leaf set nothing else is ever shown
  options.form = role.renderer == "gl" ? client::DecodeForm::kMesh : client::DecodeForm::kSplats;
  client::FrameOptions frame_options;
  frame_options.samples_per_pixel = role.samples;
  auto renderer = FrameRenderer::create(role.renderer == "gl" ? client::Renderer::kGl : client::Renderer::kCpu, role.display, frame_options);
  if (!renderer) return complain(renderer.error());
  options.store_bytes = client::store_bytes(options.store_bytes, role.renderer == "gl" ? client::Renderer::kGl : client::Renderer::kCpu,
                                            (*renderer)->abilities().is_software);
  ClientCore core(options);
  core.start();
  const auto scene = core.wait_welcome(std::chrono::seconds(60));
  if (!scene) return complain(scene.error());
  Walker walker(role, *trace, core, **renderer, *scene);
  const Result<Walk> walk = role.mode == "lockstep" ? walker.lockstep() : walker.realtime();
  if (!walk) return complain(walk.error());
  std::cout << to_json(*walk, core.statistics()).dump() << std::endl;
  return 0;
}

}  // namespace farfield::bench

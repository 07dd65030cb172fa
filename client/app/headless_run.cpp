// SPDX-License-Identifier: Apache-2.0
#include "client/app/headless_run.h"

#include <thread>
#include <utility>

#include "client/input/frame_clock.h"

namespace farfield::client {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One run: the frame reused, the figures gathered.
class Run {
 public:
  Run(ClientCore& core, FrameRenderer& renderer, const HeadlessOptions& options, SceneDescription scene)
      : core_(core), renderer_(renderer), options_(options), scene_(std::move(scene)) {}

  Status lockstep();
  Status real_time();
  HeadlessOutcome outcome();

 private:
  bool is_interrupted() const { return options_.is_interrupted && *options_.is_interrupted; }
  Status wait_complete(const glm::dvec3& eye);
  Status draw(const TraceFrame& at);

  ClientCore& core_;
  FrameRenderer& renderer_;
  const HeadlessOptions& options_;
  const SceneDescription scene_;
  const Clock::time_point start_ = Clock::now();
  Frame frame_;
  FrameClock times_;
  PromiseMeans promised_;
  HeadlessOutcome outcome_;
};

Status Run::wait_complete(const glm::dvec3& eye) {
  // In steps, so that an interrupt is noticed.
  constexpr std::chrono::milliseconds kStep{100};
  const auto until = Clock::now() + options_.timeout;
  while (!is_interrupted()) {
    const auto view = core_.wait_complete(eye, kStep);
    if (view) return {};
    const bool is_over = core_.status().state == ClientState::kFailed || Clock::now() >= until;
    if (is_over) return tl::unexpected(view.error());
  }
  return fail(ErrorCode::kCancelled, "interrupted");
}

Status Run::draw(const TraceFrame& at) {
  const Pose eye = scene_.scene_from_world(at.pose);
  const std::shared_ptr<const LeafView> view = core_.view();
  const FrameReport drawn = renderer_.render(view, eye, frame_, at.time_s);
  core_.count_frame(view.get(), eye.position);
  if (drawn.drawn) promised_.add(renderer_.promise(*drawn.drawn, eye));
  times_.add(drawn.times.total_ms);
  RunReport& report = outcome_.report;
  report.void_pixels += frame_.statistics.void_pixels;
  report.crack_pixels += frame_.statistics.crack_pixels;
  report.pixels += frame_.pixels();
  if (!outcome_.walked.frames.empty()) {
    report.walked_m += glm::distance(outcome_.walked.frames.back().pose.position, at.pose.position);
  }
  outcome_.walked.frames.push_back(at);
  return options_.sink ? options_.sink(frame_, static_cast<std::size_t>(times_.frames() - 1)) : Status();
}

Status Run::lockstep() {
  Trace trace = options_.trace;
  if (trace.frames.size() == 1) {
    // Standing still: the same pose as often as asked for.
    while (trace.frames.size() < options_.frames) trace.frames.push_back(trace.frames.front());
  } else if (options_.frames > 0) {
    Result<Trace> spread = resampled(options_.trace, options_.frames);
    if (!spread) return tl::unexpected(spread.error());
    trace = std::move(*spread);
  }
  for (const TraceFrame& at : trace.frames) {
    const Pose eye = scene_.scene_from_world(at.pose);
    core_.set_pose(eye, at.time_s);
    if (Status status = wait_complete(eye.position); !status) return is_interrupted() ? Status() : status;
    if (Status status = draw(at); !status) return status;
  }
  return {};
}

Status Run::real_time() {
  const double first_s = options_.trace.frames.front().time_s;
  const double interval_s = options_.frames_per_second > 0 ? 1.0 / options_.frames_per_second : 0.0;
  double next_s = 0;
  for (std::size_t i = 0; !is_interrupted() && (options_.frames == 0 || i < options_.frames); ++i) {
    const double now_s = seconds_since(start_);
    if (i > 0 && now_s > options_.trace.seconds()) break;
    const TraceFrame at{first_s + now_s, pose_at(options_.trace, first_s + now_s)};
    core_.set_pose(scene_.scene_from_world(at.pose), at.time_s);
    if (Status status = draw(at); !status) return status;
    if (core_.status().state == ClientState::kFailed) return tl::unexpected(core_.status().error);
    next_s = std::max(next_s + interval_s, seconds_since(start_) - interval_s);
    std::this_thread::sleep_until(start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(next_s)));
  }
  return {};
}

HeadlessOutcome Run::outcome() {
  outcome_.walked.scene = scene_.name;
  RunReport& report = outcome_.report;
  report.scene = scene_.name;
  report.is_lockstep = options_.is_lockstep;
  report.is_interrupted = is_interrupted();
  report.seconds = seconds_since(start_);
  report.median_frame_ms = times_.quantile_ms(0.5);
  report.p99_frame_ms = times_.quantile_ms(0.99);
  report.promised = promised_.means();
  report.statistics = core_.statistics();
  report.frames = report.statistics.frames;
  report.late_frames = report.statistics.late_frames;
  return std::move(outcome_);
}

}  // namespace

Result<HeadlessOutcome> run_headless(ClientCore& core, FrameRenderer& renderer, const HeadlessOptions& options) {
  std::optional<SceneDescription> scene = core.scene();
  if (!scene) return fail(ErrorCode::kUnavailable, "the server has not said which scene this is");
  if (options.trace.frames.empty()) return fail(ErrorCode::kInvalidArgument, "the trace has no frames");
  Run run(core, renderer, options, std::move(*scene));
  if (Status status = options.is_lockstep ? run.lockstep() : run.real_time(); !status) {
    return tl::unexpected(status.error());
  }
  return run.outcome();
}

}  // namespace farfield::client

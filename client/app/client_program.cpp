// SPDX-License-Identifier: Apache-2.0
#include "client/app/client_program.h"

#include <atomic>
#include <memory>
#include <optional>
#include <ostream>

#include "client/app/frame_writer.h"
#include "client/app/headless_run.h"
#include "common/base/interrupt_watch.h"
#include "client/input/run_window.h"
#include "common/base/complete_file.h"
#include "common/base/one_line.h"
#include "common/net/link_proxy.h"
#include "common/trace/trace_file.h"

namespace farfield::client {
namespace {

/// What a run needs besides its options, in the order in which it must go away.
struct Parts {
  const ProgramOptions& options;
  std::ostream& talk;
  const std::atomic<bool>& is_interrupted;
  Renderer renderer = Renderer::kCpu;
  bool is_software = false;  // OpenGL without a GPU
  std::unique_ptr<LinkProxy> link;
  std::unique_ptr<ClientCore> core;
  SceneDescription scene;
};

void choose_renderer(Parts& parts) {
  if (parts.options.renderer == RendererChoice::kCpu) return;  // which knows no OpenGL, and must not pay for its libraries
  const Result<std::unique_ptr<GlContext>> context = GlContext::create_surfaceless();
  parts.is_software = context && (*context)->abilities().is_software;
  const bool is_cpu = parts.options.renderer == RendererChoice::kAuto && (!context || parts.is_software);
  parts.renderer = is_cpu ? Renderer::kCpu : Renderer::kGl;
}

FrameOptions frame_options(const Parts& parts) {
  // Uploads in real time stay a fraction of a frame; in lockstep every frame must show its own leaf set.
  constexpr std::size_t kUploadBytes = std::size_t{16} << 20;
  FrameOptions frame;
  frame.samples_per_pixel = parts.options.samples_per_pixel;
  frame.fade_seconds = parts.options.fade_s;
  if (!parts.options.is_lockstep) frame.frame_upload_bytes = kUploadBytes;
  frame.background = parts.scene.frame.background;
  return frame;
}

/// The server may be starting, so a refused connection is tried again until the timeout; an interrupt ends the wait.
Status connect(Parts& parts) {
  const ProgramOptions& options = parts.options;
  ClientOptions client;
  client.server = options.server;
  client.tls = options.tls;
  client.access_token = options.access_token;
  if (!options.link.is_none()) {
    Result<std::unique_ptr<LinkProxy>> link = LinkProxy::start(options.server, options.link);
    if (!link) return tl::unexpected(link.error());
    parts.link = std::move(*link);
    client.server = parts.link->endpoint();
  }
  client.scene = options.scene;
  client.program = "farfield-client " FARFIELD_VERSION;
  client.display = options.display;
  client.form = parts.renderer == Renderer::kCpu ? DecodeForm::kSplats : DecodeForm::kMesh;
  client.use_fallback = !options.is_lockstep;  // where every frame waits for its leaf set nothing else is ever shown
  client.store_bytes = store_bytes(options.memory_bytes, parts.renderer, parts.is_software);
  parts.core = std::make_unique<ClientCore>(client);
  parts.core->start();
  // A server that is just starting needs no word; whoever has waited longer is told why.
  constexpr std::chrono::seconds kPatience{3};
  const auto begin = std::chrono::steady_clock::now();
  const auto until = begin + std::chrono::duration<double>(options.timeout_s);
  bool has_told = false;
  for (;;) {
    Result<SceneDescription> scene = parts.core->wait_welcome(std::chrono::milliseconds(100));
    if (scene) {
      parts.scene = std::move(*scene);
      return {};
    }
    if (parts.is_interrupted) return fail(ErrorCode::kCancelled, "interrupted");
    const ClientStatus status = parts.core->status();
    const bool is_final = status.state == ClientState::kFailed;
    if (is_final || std::chrono::steady_clock::now() >= until) {
      return tl::unexpected(status.error.message.empty() ? scene.error() : status.error);
    }
    const bool is_long = std::chrono::steady_clock::now() - begin > kPatience;
    if (!has_told && is_long && !options.is_quiet && !status.error.message.empty()) {
      complain(parts.talk, "farfield-client", status.error.message + "; trying again");
      has_told = true;
    }
  }
}

Result<std::optional<Trace>> load_trace(const ProgramOptions& options) {
  if (options.trace.empty()) return std::optional<Trace>();
  Result<Trace> trace = read_trace(options.trace);
  if (!trace) return tl::unexpected(trace.error());
  if (trace->frames.empty()) {
    return fail(ErrorCode::kInvalidArgument, "{}: the trace has no frames", options.trace.string());
  }
  return std::optional<Trace>(std::move(*trace));
}

Result<RunReport> walk_headless(Parts& parts, std::optional<Trace> trace) {
  const ProgramOptions& options = parts.options;
  auto renderer = FrameRenderer::create(parts.renderer, options.display, frame_options(parts));
  if (!renderer) return tl::unexpected(renderer.error());
  HeadlessOptions headless;
  headless.is_lockstep = options.is_lockstep || !trace;
  headless.trace = trace ? std::move(*trace) : Trace{parts.scene.name, {{0, parts.scene.world_from_scene({parts.scene.start})}}};
  headless.frames = options.frames;
  headless.frames_per_second = options.frames_per_second;
  headless.timeout = std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * options.timeout_s));
  headless.is_interrupted = &parts.is_interrupted;
  std::optional<FrameWriter> writer;
  if (!options.frames_dir.empty()) {
    if (Status status = writer.emplace(options.frames_dir).prepare(); !status) return tl::unexpected(status.error());
    headless.sink = [&](const Frame& frame, std::size_t index) { return writer->write(frame, index); };
  }
  Result<HeadlessOutcome> outcome = run_headless(*parts.core, **renderer, headless);
  if (!outcome) return tl::unexpected(outcome.error());
  if (writer) {
    if (Status status = writer->finish(); !status) return tl::unexpected(status.error());
  }
  if (!options.record.empty() && !outcome->walked.frames.empty()) {
    if (Status status = write_trace(options.record, outcome->walked); !status) return tl::unexpected(status.error());
  }
  return std::move(outcome->report);
}

Result<RunReport> walk_in_window(Parts& parts, std::optional<Trace> trace) {
  WindowOptions window;
  window.renderer = parts.renderer;
  window.display = parts.options.display;
  window.frame = frame_options(parts);
  window.start = {parts.scene.start};
  window.origin = parts.scene.origin;
  window.scene = parts.scene.name;
  window.replay = std::move(trace);
  window.most_frames = parts.options.frames;
  if (!parts.options.record.empty()) {
    window.record_path = parts.options.record.string();
    window.records_from_start = true;
  }
  const Result<WindowSummary> summary = run_window(window_source(*parts.core), window);
  if (!summary) return tl::unexpected(summary.error());
  RunReport report;
  report.scene = parts.scene.name;
  report.seconds = summary->seconds;
  report.frames = summary->frames;
  report.late_frames = summary->late_frames;
  report.median_frame_ms = summary->median_frame_ms;
  report.p99_frame_ms = summary->p99_frame_ms;
  report.statistics = parts.core->statistics();
  return report;
}

Result<RunReport> walk(Parts& parts) {
  // Said before the walk, which may take minutes.
  if (!parts.options.record.empty()) {
    if (Status status = check_file_can_be_written(parts.options.record); !status) return tl::unexpected(status.error());
  }
  Result<std::optional<Trace>> trace = load_trace(parts.options);
  if (!trace) return tl::unexpected(trace.error());
  choose_renderer(parts);
  if (Status status = connect(parts); !status) return tl::unexpected(status.error());
  if (!parts.options.is_quiet) {
    complain(parts.talk, "farfield-client", fmt::format("{} at {}, {} triangles", parts.scene.name,
                                                        to_string(parts.options.server), parts.scene.triangles));
  }
  Result<RunReport> report = parts.options.is_window ? walk_in_window(parts, std::move(*trace))
                                                     : walk_headless(parts, std::move(*trace));
  if (report) report->renderer = parts.renderer == Renderer::kCpu ? "cpu" : "gl";
  return report;
}

}  // namespace

int run_client(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk) {
  const tl::expected<ProgramOptions, int> options = parse_options(argument_count, arguments, out, talk);
  if (!options) return options.error();
  // The window ends by its own keys, and by the signal's own way where it has to.
  std::optional<InterruptWatch> interrupts;
  if (!options->is_window) interrupts.emplace();
  const std::atomic<bool> never{false};
  Parts parts{*options, talk, interrupts ? interrupts->is_interrupted() : never};
  const Result<RunReport> report = walk(parts);
  if (report) write_report(*report, options->is_json, out);
  if (report && !out) {
    complain(talk, "farfield-client", "the report cannot be written to the output");
    return kExitFailure;
  }
  if (parts.is_interrupted) return kExitInterrupted;
  if (report) return 0;
  complain(talk, "farfield-client", report.error().message);
  return report.error().code == ErrorCode::kInvalidArgument ? kExitUsage : kExitFailure;
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/farfield_method.h"

#include <sys/resource.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "common/net/link_proxy.h"
#include "common/trace/trace_file.h"
#include "server/app/build_service.h"
#include "server/encode/tile_maker.h"
#include "server/session/server.h"
#include "server/store/memory_tile_store.h"
#include "tests/bench/client_process.h"
#include "tests/bench/distribution.h"
#include "tests/bench/explain.h"
#include "tests/bench/judge.h"
#include "tests/bench/promises.h"
#include "tests/bench/scratch_folder.h"
#include "tests/bench/skip_savings.h"
#include "tests/bench/warp_error.h"

namespace farfield::bench {
namespace {

struct Serving {
  std::shared_ptr<MemoryTileStore> store;
  std::shared_ptr<JobPool> pool;
  std::shared_ptr<MeasuredCellService> service;
  std::unique_ptr<Server> server;
  ~Serving() {
    server.reset();
    service.reset();
  }
};

/// What one run is to use, knobs applied.
struct FarfieldSettings {
  std::string renderer;
  ImpostorSettings impostor;
  int client_samples = 0;
};

Result<std::unique_ptr<Serving>> serve(const World& world, const ImpostorSettings& settings) {
  auto serving = std::make_unique<Serving>();
  serving->store = std::make_shared<MemoryTileStore>(std::size_t{4} << 30);
  serving->pool = std::make_shared<JobPool>(world.options.threads);
  ServiceOptions options;
  options.settings = settings;
  options.store = serving->store, options.pool = serving->pool;
  // As in farfield-server; what it does takes microseconds and need not be paused while frames are drawn.
  options.prompt_pool = std::make_shared<JobPool>(2, JobPool::kDefaultQueueCapacity, steady_clock_seconds(), "prompt");
  serving->service = service_for_scene("bench", prepared(world.scene), options);
  ServerOptions server_options;
  server_options.listen = {"127.0.0.1", 0};
  auto server = Server::start(server_options, {serving->service});
  if (!server) return tl::unexpected(server.error());
  serving->server = std::move(*server);
  return serving;
}

ErrorFigures judge_lockstep(const World& world, const std::filesystem::path& folder, std::vector<KeptPromise>& promises, MethodResult& result) {
  ErrorAverage errors(world.options.display);
  for (std::size_t k = 0; k < world.poses.size(); ++k) {
    const Result<DumpedFrame> dump = read_frame(frame_path(folder, k));
    if (!dump) continue;
    const JudgedFrame frame = judged(dump->frame);
    errors.add(frame, world.truth[k], world.is_far_at(k));
    if (k < promises.size()) promises[k].void_share = errors.last_void_share(), promises[k].psnr_db = errors.last_impostor_psnr();
    result.pictures.push_back(frame.rgb);
  }
  return errors.figures();
}

// Real-time frames were shown where the viewer was at that moment: truth is rendered there.
ErrorFigures judge_realtime(const World& world, const std::filesystem::path& folder) {
  ErrorAverage errors(world.options.display);
  for (std::size_t k = 0; k < world.poses.size(); ++k) {
    const Result<DumpedFrame> dump = read_frame(frame_path(folder, k));
    if (!dump) continue;
    const Pose eye = world.scene_from_world(dump->eye);
    const ReferenceImage truth = render_reference(*world.scene, eye, world.options.display, world.options.truth_samples);
    errors.add(judged(dump->frame), truth, world.cells->far_pixels(eye, world.options.display, truth));
  }
  return errors.figures();
}

// Walked by another client after everything else has been measured: its tiles are no part of the walk's.
Result<BorderFlip> judge_borders(const World& world, const FarfieldSettings& wanted, const Serving& serving) {
  const Result<ScratchFolder> folder = ScratchFolder::create();
  if (!folder) return tl::unexpected(folder.error());
  const Trace trace = world.border->trace();
  if (trace.frames.empty()) return BorderFlip{};
  const std::filesystem::path file = folder->path() / "pairs.trace";
  if (Status status = write_trace(file, trace); !status) return tl::unexpected(status.error());
  const ClientRun run{serving.server->endpoint(), wanted.renderer, "lockstep", folder->path(), file, trace.frames.size(), wanted.client_samples};
  const auto client = run_client(world.options.display, run, *serving.pool);
  if (!client) return tl::unexpected(client.error());
  return world.border->judge(world.options.display, [&](std::size_t index) {
    return read_frame(frame_path(folder->path(), index)).map([](const DumpedFrame& dump) { return judged(dump.frame).rgb; });
  });
}

void add_cells(const Serving& serving, MethodResult& result) {
  const int threads = std::max(1, serving.pool->pool_statistics().threads);
  std::vector<double> cell, intra, ratio, bytes;
  double disparity_bytes = 0, covered = 0;
  StageSeconds stages;
  double plan_seconds = 0;
  for (const CellStatistics& c : serving.service->cell_statistics()) {
    disparity_bytes += static_cast<double>(c.disparity_bytes), covered += static_cast<double>(c.covered_samples);
    if (!c.is_leaf || c.tiles == 0) continue;
    cell.push_back(1e3 * c.seconds / threads), intra.push_back(1e3 * c.stages.intra / threads);
    stages += c.stages, plan_seconds += c.visibility_seconds;
    if (c.stages.intra > 0) ratio.push_back(c.seconds / c.stages.intra);
    bytes.push_back(static_cast<double>(c.bytes));
  }
  result.cell_p50 = percentile(cell, 0.5), result.cell_p95 = percentile(cell, 0.95), result.cell_max = largest(cell);
  result.intra_p50 = percentile(intra, 0.5), result.cell_to_intra = percentile(ratio, 0.5);
  result.cell_count = static_cast<double>(cell.size());
  const auto put_stage = [&](const char* name, double seconds) { result.cell_stages[name] = 1e3 * seconds / threads / result.cell_count; };
  if (!cell.empty()) {
    put_stage("plan", plan_seconds), put_stage("intra", stages.intra), put_stage("search", stages.search), put_stage("delta", stages.delta);
    put_stage("cuts", stages.cuts), put_stage("colours", stages.colours), put_stage("encode", stages.encode), put_stage("certify", stages.certify);
  }
  result.bytes_per_cell = mean(bytes);
  result.depth_bits = covered > 0 ? 8 * disparity_bytes / covered : kNone;
}

void add_skips(const Serving& serving, MethodResult& result) {
  const CellServiceStatistics statistics = serving.service->statistics();
  const auto put = [&](const char* name, std::uint64_t count) { result.skipped[name] = static_cast<double>(count); };
  const TileSkips& skips = statistics.skipped;
  put("empty_tiles", skips.empty_tiles), put("samples_coloured_once", skips.samples_coloured_once);
  put("hidden_samples", skips.hidden_samples), put("delta_blocks_hidden", skips.delta_blocks_hidden);
  put("delta_blocks_not_cast", skips.delta_blocks_not_cast), put("delta_samples_held", skips.delta_samples_held);
  put("samples_without_depth", skips.samples_without_depth);
  put("identical_tiles", skips.identical_tiles), put("identical_bytes", skips.identical_bytes);
  const PlanSkips& plans = statistics.left_out;
  put("tiles_unseen", plans.tiles_unseen), put("tiles_too_small", plans.tiles_too_small);
  put("delta_views_unneeded", plans.delta_views_unneeded), put("blocked_cells", plans.blocked_cells);
  put("chunks_facing_away", plans.chunks_facing_away), put("chunks_unseen", plans.chunks_unseen);
  put("triangles_unseen", plans.triangles_unseen);
  const SessionMetrics& sessions = serving.server->metrics();
  put("payloads_held", sessions.payloads_held), put("tiles_held", sessions.tiles_held);
  put("payload_bytes_held", sessions.payload_bytes_held), put("leaves_blocked_ahead", sessions.leaves_blocked_ahead);
}

double number(const nlohmann::json& json, const char* key) { return json.value(key, kNone); }

void add_bytes(const World& world, const nlohmann::json& client, MethodResult& result) {
  result.bytes_total = number(client, "bytes_in") + number(client, "bytes_out");
  result.bytes_entry = number(client, "entry_bytes");
  const double warm = result.bytes_total - result.bytes_entry;
  result.bytes_per_metre = warm / std::max(1e-9, length_of(world.trace));
  result.bytes_near = number(client, "near_geometry"), result.bytes_textures = number(client, "textures");
  result.bytes_colour = number(client, "colour"), result.bytes_disparity = number(client, "disparity");
  result.bytes_messages = number(client, "control");
  result.bytes_other = number(client, "tile_other") + number(client, "control");
  result.skipped["redundant_payloads"] = number(client, "redundant");
  result.skipped["bad_payloads"] = number(client, "bad");
}

Result<MethodResult> run_farfield(const World& world, const FarfieldSettings& wanted) {
  MethodResult result;
  std::vector<KeptPromise> promises;  // of the lockstep frames
  for (const std::string mode : {"lockstep", "realtime"}) {
    if (mode == "realtime" && !world.options.is_realtime_wanted) break;
    std::cerr << "farfield-" << wanted.renderer << ": " << mode << '\n';
    const Result<ScratchFolder> folder = ScratchFolder::create();
    if (!folder) return tl::unexpected(folder.error());
    const auto serving = serve(world, wanted.impostor);
    if (!serving) return tl::unexpected(serving.error());
    const bool is_linked = mode == "realtime" && !world.options.link_model.is_none();
    std::unique_ptr<LinkProxy> proxy;
    if (is_linked) {
      auto started = LinkProxy::start((*serving)->server->endpoint(), world.options.link_model);
      if (!started) return tl::unexpected(started.error());
      proxy = std::move(*started);
    }
    const Endpoint endpoint = is_linked ? proxy->endpoint() : (*serving)->server->endpoint();
    const ClientRun run{endpoint, wanted.renderer, mode, folder->path(), world.options.trace, world.poses.size(), wanted.client_samples};
    const auto client = run_client(world.options.display, run, *(*serving)->pool);
    if (!client) return tl::unexpected(client.error());
    const std::vector<double> frame_ms = (*client)["frame_ms"].get<std::vector<double>>();
    result.client_rss_mb = std::max(std::isnan(result.client_rss_mb) ? 0 : result.client_rss_mb, number(*client, "peak_rss_mb"));
    result.late_share = number(*client, "late_share");  // of the last run: in lockstep it would always be 0
    result.blank_frames = number(*client, "blank");
    if (mode == "lockstep") {
      add_bytes(world, *client, result);
      result.frame_p50 = percentile(frame_ms, 0.50), result.frame_p95 = percentile(frame_ms, 0.95), result.frame_p99 = percentile(frame_ms, 0.99);
      result.triangles = mean((*client)["triangles"].get<std::vector<double>>());
      result.samples = mean((*client)["samples"].get<std::vector<double>>());
      add_cells(**serving, result);
      add_skips(**serving, result);
      if (world.options.explains) result.explained = explained_cells((*serving)->service->cell_statistics());
      for (const nlohmann::json& promise : (*client)["promises"]) promises.push_back({promise_from(promise)});
      result.error = judge_lockstep(world, folder->path(), promises, result);
      if (world.border) {
        const Result<BorderFlip> border = judge_borders(world, wanted, **serving);
        if (!border) return tl::unexpected(border.error());
        result.border_flip = *border;
      }
      // Without real time, the rate is what the walk would need with its clock running.
      result.mbit_s_warm = 8e-6 * (result.bytes_total - result.bytes_entry) / std::max(1e-9, world.trace.seconds());
    } else {
      result.realtime_frame_p50 = percentile(frame_ms, 0.50), result.realtime_frame_p99 = percentile(frame_ms, 0.99);
      result.realtime_error = judge_realtime(world, folder->path());
      // A viewer ahead of the server is sent less than the walk needs: a figure of its own, beside lockstep's.
      const double bytes = number(*client, "bytes_in") + number(*client, "bytes_out") - number(*client, "entry_bytes");
      result.realtime_mbit_s = 8e-6 * bytes / std::max(1e-9, number(*client, "seconds"));
      result.fallback_share = number(*client, "fallback_frames") / std::max(1.0, number(*client, "frames"));
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    result.server_rss_mb = static_cast<double>(usage.ru_maxrss) / 1024;
  }
  ImpostorSettings settings = wanted.impostor;
  settings.finest_side_m = finest_side_for(*world.scene, settings.finest_side_m);
  const ImpostorSources sources = make_impostor_sources(world.scene, settings);
  const WarpErrors warp = warp_errors(world, sources, settings, wanted.renderer == "gl");
  result.error.warp_px_p99 = warp.p99;
  for (const auto& [frame, p99] : warp.frame_p99)
    if (frame < promises.size()) promises[frame].warp_px = p99;
  result.certificate = certificate_figures(promises);
  result.kept_promises = std::move(promises);
  if (world.options.explains) {
    std::cerr << "farfield-" << wanted.renderer << ": what was saved\n";
    result.savings = measure_savings(world, settings, result);
  }
  return result;
}

FarfieldSettings with_knobs(const World& world, const std::string& renderer, const KnobValues& knobs) {
  FarfieldSettings wanted{renderer, world.options.settings, knobs.whole("client-samples")};
  ImpostorSettings& s = wanted.impostor;
  s.display = world.options.display;
  s.colour_quality = knobs.whole("quality"), s.tau_px = knobs["tau"], s.face_tiles = knobs.whole("face-tiles");
  s.delta_views = knobs.whole("delta-views"), s.void_target = knobs["void-target"];
  s.has_one_slope = knobs.whole("one-slope") != 0;
  s.rate.cell_bytes = knobs["cell-bytes"], s.rate.psnr_db = knobs["target-psnr"];
  return wanted;
}

}  // namespace

Method farfield_method(const std::string& renderer, const BenchOptions& defaults) {
  const ImpostorSettings& s = defaults.settings;
  const bool is_gl = renderer == "gl";
  return {"farfield-" + renderer, is_gl ? "Farfield, its meshes through OpenGL" : "Farfield, its samples warped on the processor",
          {{"quality", double(s.colour_quality), "quality of colours on the scale of JPEG", 1, 100, true},
           {"tau", s.tau_px, "guaranteed warp error of coded disparity, pixels", 0.01, 16},
           {"face-tiles", double(s.face_tiles), "tiles along a face's edge: the sample rate", 1, 64, true},
           {"delta-views", double(s.delta_views), "delta views per cell, at most", 0, 32, true},
           {"void-target", s.void_target, "share of the sphere below which voids get no further delta view", 0, 1},
           {.name = "one-slope", .default_value = s.has_one_slope ? 1.0 : 0.0, .description = "1: a byte of colour buys the same error as seen in every tile", .choices = {0, 1}},
           {"cell-bytes", s.rate.cell_bytes, "bytes of a cell's own impostor as one leaf needs it; 0: no budget", 0, 1e9},
           {"target-psnr", s.rate.psnr_db, "what coding may leave of a cell's colours, decibels; 0: no target", 0, 60},
           {.name = "client-samples", .default_value = double(defaults.client_samples), .description = "samples per pixel of the client; 0: its choice", .choices = {0, 1, 4}}},
          [renderer](const World& world, const KnobValues& knobs) { return run_farfield(world, with_knobs(world, renderer, knobs)); },
          true, true};
}

}  // namespace farfield::bench

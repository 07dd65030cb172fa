// SPDX-License-Identifier: Apache-2.0
#include "server/app/bake_tool.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/command_line.h"
#include "common/base/interrupt_watch.h"
#include "common/trace/trace_file.h"
#include "server/app/build_service.h"
#include "server/app/load_arguments.h"
#include "server/app/quality_arguments.h"
#include "server/app/store_arguments.h"
#include "server/store/memory_tile_store.h"

namespace farfield {
namespace {

constexpr const char* kProgram = "farfield-bake";
constexpr int kInterruptedExit = 130;
constexpr std::size_t kMemoryBytes = std::size_t{1} << 30;
constexpr int kPromptThreads = 4;

constexpr const char* kFooter = R"(Examples:
  farfield-bake --scene plant.glb --store /var/cache/farfield --trace walks
  farfield-bake --scene pipes:1000000:1 --store cells --region 0,0,0,20,2,20
  farfield-bake --scene plant.glb --redis cache.example:6379 --trace walk.trace

What is stored already is found, not made: stop a bake with Ctrl-C and start it again, and it goes on.
Quality options must be the server's, or it will not find the cells.
Exit codes: 0 done, 1 failed, 2 wrong usage, 130 interrupted.)";

Result<std::vector<Trace>> read_traces(const std::vector<std::filesystem::path>& places) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& place : places) {
    std::error_code error;
    if (!std::filesystem::is_directory(place, error)) {
      files.push_back(place);
      continue;
    }
    const std::size_t before = files.size();
    for (const auto& entry : std::filesystem::directory_iterator(place, error)) {
      if (entry.path().extension() == ".trace") files.push_back(entry.path());
    }
    if (error) return fail(ErrorCode::kIo, "--trace: the folder {} cannot be read: {}", place.string(), error.message());
    if (files.size() == before) return fail(ErrorCode::kNotFound, "--trace: no *.trace file in the folder {}", place.string());
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  std::vector<Trace> traces;
  for (const std::filesystem::path& file : files) {
    Result<Trace> trace = read_trace(file);
    if (!trace) return tl::unexpected(trace.error());
    traces.push_back(std::move(*trace));
  }
  return traces;
}

std::string time_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  return whole < 120 ? fmt::format("{} s", whole) : whole < 7200 ? fmt::format("{} min", (whole + 30) / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

std::string progress_line(const BakeProgress& p) {
  std::string line = fmt::format("{:.0f} % · {} leaves · {} tiles, {} made · {:.1f} MB · {}", 100.0 * static_cast<double>(p.places_done) / static_cast<double>(std::max<std::uint64_t>(1, p.places)),
                                 p.leaves, p.tiles, p.tiles_made, megabytes(p.bytes), time_text(p.seconds));
  if (p.seconds_left) line += fmt::format(" · about {} and {:.0f} MB more", time_text(*p.seconds_left), megabytes(*p.bytes_expected - p.bytes));
  return line;
}

/// One line that is written over on a terminal, else a line every ten seconds.
class ProgressLine {
 public:
  explicit ProgressLine(std::ostream& talk) : talk_(talk), is_terminal_(&talk == &std::cerr && isatty(STDERR_FILENO)) {}
  void show(const BakeProgress& progress) {
    constexpr int kEvery = 10;
    if (is_terminal_) talk_ << "\r\x1b[K" << progress_line(progress) << std::flush;
    else if (++count_ % kEvery == 0) talk_ << kProgram << ": " << progress_line(progress) << std::endl;
  }
  void end() {
    if (is_terminal_) talk_ << "\r\x1b[K" << std::flush;
  }

 private:
  std::ostream& talk_;
  bool is_terminal_;
  int count_ = 0;
};

std::string as_text(const BakeProgress& p, bool is_complete) {
  return fmt::format("baked      {}\nplaces     {} of {}{}\nleaves     {}\ntiles      {}, of them {} made and the rest found\nbytes      {:.2f} MB\nseconds    {:.1f}\nfailed     {}\n",
                     is_complete ? "all" : "a part: start it again to go on", p.places_done, p.places,
                     p.blocked > 0 ? fmt::format(", {} of them where nobody can stand", p.blocked) : "", p.leaves, p.tiles, p.tiles_made,
                     megabytes(p.bytes), p.seconds, p.failed);
}

Result<BakeWork> work_for(const BakeOptions& options, const std::vector<Trace>& traces, const SceneDescription& scene) {
  const CellGrid grid{scene.settings.finest_side_m};
  if (!options.region) {
    auto places = std::make_shared<std::vector<glm::dvec3>>(places_along(traces, scene.world_origin, grid));
    return BakeWork{places->size(), [places](std::uint64_t index) { return (*places)[index]; }, false};
  }
  Box box{options.region->min - scene.world_origin, options.region->max - scene.world_origin};
  box.min = glm::max(box.min, scene.bounds.min), box.max = glm::min(box.max, scene.bounds.max);
  if (box.is_empty()) return fail(ErrorCode::kInvalidArgument, "--region: the box lies outside the scene");
  const PlacesInBox places(box, grid);
  return BakeWork{places.count(), [places](std::uint64_t index) { return places.place(index); }, true};
}

}  // namespace

std::string bake_json(const BakeProgress& p, bool is_complete) {
  const nlohmann::json json{{"format", "farfield-bake/1"}, {"complete", is_complete}, {"places", p.places}, {"places_done", p.places_done},
                            {"blocked", p.blocked}, {"leaves", p.leaves}, {"tiles", {{"all", p.tiles}, {"made", p.tiles_made}}}, {"bytes", p.bytes},
                            {"seconds", p.seconds}, {"failed", p.failed}};
  return json.dump();
}

Result<bool> run_bake(const BakeOptions& options, const std::atomic<bool>& is_stopped, std::ostream& out, std::ostream& talk) {
  const Result<std::vector<Trace>> traces = read_traces(options.traces);
  if (!traces) return tl::unexpected(traces.error());
  ServiceOptions service_options;
  service_options.load = options.load;
  service_options.settings = options.settings;
  service_options.log = [&talk](const std::string& line) { talk << kProgram << ": " << line << std::endl; };
  Result<OpenStores> stores = open_stores(options.stores, service_options.log);
  if (!stores) return tl::unexpected(stores.error());
  if (const std::size_t bytes = prepared_bytes(options.stores)) service_options.prepared = std::make_shared<PreparedScenes>(options.stores.folder, bytes);
  service_options.store = std::make_shared<MemoryTileStore>(kMemoryBytes);
  service_options.blobs = stores->blobs, service_options.lease = stores->lease;
  service_options.pool = std::make_shared<JobPool>(options.threads);
  service_options.prompt_pool = std::make_shared<JobPool>(kPromptThreads, JobPool::kDefaultQueueCapacity, steady_clock_seconds(), "prompt");
  const auto service = build_service({options.scene, options.scene}, service_options);
  if (!service) return tl::unexpected(service.error());
  const Result<BakeWork> work = work_for(options, *traces, (*service)->scene());
  if (!work) return tl::unexpected(work.error());

  ProgressLine line(talk);
  // As many again as cast: while one leaf's last tile is cast, another's have begun.
  const int casting = options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const BakeProgress progress = bake(**service, *work, 2 * casting, is_stopped, [&](const BakeProgress& now) { line.show(now); });
  line.end();
  const Status written = stores->blobs->flush();
  if (service_options.prepared && !is_stopped) service_options.prepared->finish();
  const bool is_complete = progress.places_done == progress.places && !is_stopped && progress.failed == 0;
  out << (options.is_json ? bake_json(progress, is_complete) + "\n" : as_text(progress, is_complete)) << std::flush;
  if (!written) return fail_within("what was baked is not all stored", written.error());
  if (progress.failed > 0) return fail(ErrorCode::kInternal, "{} leaves or tiles could not be made, the first: {}", progress.failed, progress.first_error);
  if (!out) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  return !is_complete;
}

int run_bake_tool(int argument_count, const char* const* arguments) {
  CLI::App app{"Make cells ahead of time, so that viewers find them stored.", kProgram};
  app.footer(kFooter);
  app.set_version_flag("--version", std::string(kProgram) + " " FARFIELD_VERSION);
  BakeOptions options;
  StoreArguments stores;
  LoadArguments load;
  std::vector<double> region;
  app.add_option("--scene", options.scene, "Scene to bake: a model file or KIND:TRIANGLES:SEED")->required();
  app.add_option("--trace", options.traces, "Camera paths to bake along: files, or folders of *.trace; repeatable");
  app.add_option("--region", region, "Box to bake, X0,Y0,Z0,X1,Y1,Z1 in world metres: wherever somebody can stand in it")->delimiter(',')->expected(6);
  app.add_option("--threads", options.threads, "Threads that make tiles (default: one per processor)")->check(whole_number_between(1, 1024));
  stores.add_to(app);
  load.add_to(app);
  add_quality_options(app, options.settings);
  app.add_flag("--json", options.is_json, "Report as JSON");
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, std::cout, std::cerr)) return *over;
  const auto wrong = [](const std::string& message) {
    complain(std::cerr, kProgram, message);
    return 2;
  };
  const Result<StoreOptions> store_options = stores.options();
  if (!store_options) return wrong(store_options.error().message);
  options.stores = *store_options;
  options.load = load.options();
  if (options.stores.folder.empty() && !options.stores.redis) return wrong("nowhere to keep what is baked: give --store FOLDER or --redis HOST:PORT");
  if (options.traces.empty() == region.empty()) return wrong("give either --trace or --region");
  if (!region.empty()) {
    options.region = Box{{region[0], region[1], region[2]}, {region[3], region[4], region[5]}};
    if (options.region->is_empty()) return wrong("--region: the first corner must be the lower one on every axis");
  }
  if (options.settings.face_tiles == 0) options.settings.face_tiles = face_tiles_for(options.settings.display, options.settings.kappa);
  InterruptWatch interrupts;
  const Result<bool> stopped = run_bake(options, interrupts.is_interrupted(), std::cout, std::cerr);
  if (stopped) return *stopped ? kInterruptedExit : 0;
  complain(std::cerr, kProgram, stopped.error().message);
  return stopped.error().code == ErrorCode::kInvalidArgument ? 2 : 1;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/app/trace_tool.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "common/base/command_line.h"
#include "common/base/complete_file.h"
#include "common/image/png.h"
#include "common/trace/trace_file.h"
#include "server/app/load_arguments.h"
#include "server/app/trace_map.h"

namespace farfield {
namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr const char* kFooter = R"(Examples:
  farfield-trace generate pipes:1000000:1 --kind walk --seconds 30 -o walk.txt
  farfield-trace generate plant.glb --count 20 --seconds 30 -o walks
  farfield-trace generate delft.city.json --kind fly --speed 12 --seed 3 -o flight.txt
  farfield-trace show walk.txt
  farfield-trace show walk.txt --scene pipes:1000000:1 --svg walk.svg --png walk.png

A trace is text: one line "t x y z qx qy qz qw" per frame, seconds and metres, world coordinates.
Exit codes: 0 done, 1 failed, 2 wrong usage.)";

Result<std::shared_ptr<const Scene>> load_scene(const std::string& argument, const LoadOptions& options) {
  Result<Model> model = load_model(argument, options);
  if (!model) return tl::unexpected(model.error());
  return Scene::build(std::move(*model));
}

nlohmann::json as_json(const TraceSummary& s, const Trace& trace, const std::filesystem::path& file) {
  const auto array = [](const glm::dvec3& v) { return nlohmann::json::array({v.x, v.y, v.z}); };
  return {{"file", file.string()}, {"scene", trace.scene}, {"frames", s.frames}, {"seconds", s.seconds}, {"length_m", s.length_m},
          {"speed_mean_m_s", s.speed_mean_m_s}, {"speed_p95_m_s", s.speed_p95_m_s}, {"turn_p95_deg_s", s.turn_p95_rad_s * kDegrees},
          {"bounds_min", array(s.bounds.min)}, {"bounds_max", array(s.bounds.max)}};
}

std::string as_text(const TraceSummary& s, const Trace& trace, const std::filesystem::path& file) {
  const glm::dvec3 &low = s.bounds.min, &high = s.bounds.max;
  return fmt::format("trace      {}\nscene      {}\nframes     {}\nseconds    {:.3f}\nlength     {:.6g} m\n"
                     "speed      {:.4g} m/s mean, {:.4g} m/s p95\nturning    {:.1f} deg/s p95\n"
                     "bounds     ({:.3f} {:.3f} {:.3f}) .. ({:.3f} {:.3f} {:.3f}) m\n",
                     file.string(), trace.scene.empty() ? "(not named)" : trace.scene, s.frames, s.seconds, s.length_m, s.speed_mean_m_s,
                     s.speed_p95_m_s, s.turn_p95_rad_s * kDegrees, low.x, low.y, low.z, high.x, high.y, high.z);
}

CLI::App* add_generate(CLI::App& app, TraceGenerateOptions& options, std::string& kind, LoadArguments& load) {
  CLI::App* command = app.add_subcommand("generate", "Make a smooth camera path that touches nothing");
  command->add_option("SCENE", options.scene, "Model file or KIND:TRIANGLES:SEED")->required();
  command->add_option("--kind", kind, "walk (eyes 1.7 m above the floor), fly or orbit")->check(CLI::IsMember({"walk", "fly", "orbit"}))->capture_default_str();
  command->add_option("--speed", options.trace.speed_m_s, "Metres per second (default: walk 1.4, fly 4, orbit one turn)")->check(number_between(0, 1e6));
  command->add_option("--seconds", options.trace.seconds, "Duration")->check(number_between(1e-3, 86400))->capture_default_str();
  command->add_option("--seed", options.trace.seed, "Another seed, another path")->check(whole_number_between(0, UINT64_MAX))->capture_default_str();
  command->add_option("--fps", options.trace.frames_per_second, "Frames per second")->check(number_between(0.01, 10000))->capture_default_str();
  command->add_option("--count", options.count, "Traces to make, with this and the next seeds, as SEED.trace in the folder -o")->check(whole_number_between(1, 100'000))->capture_default_str();
  command->add_option("-o,--output", options.output, "File to write; with --count above 1 the folder")->required();
  command->add_flag("--json", options.is_json, "Report as JSON");
  load.add_to(*command);
  return command;
}

CLI::App* add_show(CLI::App& app, TraceShowOptions& options, LoadArguments& load) {
  CLI::App* command = app.add_subcommand("show", "Report a trace in numbers and draw it from above");
  command->add_option("FILE", options.file, "Trace file")->required();
  command->add_option("--scene", options.scene, "Scene to draw it in: model file or KIND:TRIANGLES:SEED");
  command->add_option("--svg", options.svg, "Also write the drawing as SVG");
  command->add_option("--png", options.png, "Also write the drawing as PNG");
  command->add_flag("--json", options.is_json, "Report as JSON, without the drawing");
  load.add_to(*command);
  return command;
}

}  // namespace

namespace {

// One trace, written and reported.
Status write_and_report(Trace trace, const TraceGenerateOptions& options, const std::filesystem::path& file, std::ostream& out) {
  trace.scene = options.scene;
  if (const Status status = write_trace(file, trace); !status) return status;
  const TraceSummary summary = summarise(trace);
  out << (options.is_json ? as_json(summary, trace, file).dump(options.count > 1 ? -1 : 2) + '\n' : as_text(summary, trace, file)) << std::flush;
  if (!out) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  return {};
}

// A seed from which no path is found is passed over; as many as are wanted in a row are too many.
Status generate_several(const Scene& scene, const TraceGenerateOptions& options, std::ostream& out) {
  std::error_code error;
  std::filesystem::create_directories(options.output, error);
  if (error) return fail(ErrorCode::kIo, "the folder {} cannot be made: {}", options.output.string(), error.message());
  TraceOptions wanted = options.trace;
  std::size_t passed_over = 0;
  for (std::size_t made = 0; made < options.count; ++wanted.seed) {
    Result<Trace> trace = generate_trace(scene, wanted);
    if (!trace && (trace.error().code != ErrorCode::kNotFound || ++passed_over > options.count)) return tl::unexpected(trace.error());
    if (!trace) continue;
    const std::filesystem::path file = options.output / fmt::format("{}.trace", wanted.seed);
    if (const Status status = write_and_report(std::move(*trace), options, file, out); !status) return status;
    ++made;
  }
  return {};
}

}  // namespace

Status run_trace_generate(const TraceGenerateOptions& options, std::ostream& out, std::ostream& talk) {
  if (options.count == 1)
    if (const Status status = check_file_can_be_written(options.output); !status) return status;
  const Result<std::shared_ptr<const Scene>> scene = load_scene(options.scene, options.load);
  if (!scene) return tl::unexpected(scene.error());
  if (options.count > 1) return generate_several(**scene, options, out);
  std::string note;
  Result<Trace> trace = generate_trace(**scene, options.trace, &note);
  if (!trace) return tl::unexpected(trace.error());
  if (!note.empty()) complain(talk, "farfield-trace", note);
  return write_and_report(std::move(*trace), options, options.output, out);
}

Status run_trace_show(const TraceShowOptions& options, std::ostream& out) {
  const Result<Trace> trace = read_trace(options.file);
  if (!trace) return tl::unexpected(trace.error());
  std::shared_ptr<const Scene> scene;
  if (!options.scene.empty()) {
    Result<std::shared_ptr<const Scene>> loaded = load_scene(options.scene, options.load);
    if (!loaded) return tl::unexpected(loaded.error());
    scene = std::move(*loaded);
  }
  const TraceSummary summary = summarise(*trace);
  if (options.is_json) {
    out << as_json(summary, *trace, options.file).dump(2) << '\n';
  } else {
    out << as_text(summary, *trace, options.file) << '\n' << text_map(*trace, scene.get());
  }
  out.flush();
  if (!out) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  if (!options.svg.empty()) {
    if (const Status status = write_complete_file(options.svg, svg_map(*trace, scene.get())); !status) return status;
  }
  if (!options.png.empty()) return write_png(options.png.string(), png_map(*trace, scene.get()));
  return {};
}

int run_trace_tool(int argument_count, const char* const* arguments) {
  CLI::App app{"Camera traces: make paths through scenes that touch nothing, and look at recorded ones.", "farfield-trace"};
  app.footer(kFooter);
  app.set_version_flag("--version", "farfield-trace " FARFIELD_VERSION);
  app.require_subcommand(1);
  TraceGenerateOptions generate;
  TraceShowOptions show;
  LoadArguments generate_load, show_load;
  std::string kind = "walk";
  const CLI::App* generate_command = add_generate(app, generate, kind, generate_load);
  add_show(app, show, show_load);
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, std::cout, std::cerr)) return *over;
  generate.trace.kind = *trace_kind_of(kind);
  generate.load = generate_load.options();
  show.load = show_load.options();
  const Status status = generate_command->parsed() ? run_trace_generate(generate, std::cout, std::cerr) : run_trace_show(show, std::cout);
  if (status) return 0;
  complain(std::cerr, "farfield-trace", status.error().message);
  return status.error().code == ErrorCode::kInvalidArgument ? 2 : 1;
}

}  // namespace farfield

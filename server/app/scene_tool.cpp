// SPDX-License-Identifier: Apache-2.0
#include "server/app/scene_tool.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <ostream>

#include "common/base/command_line.h"
#include "common/base/complete_file.h"
#include "server/app/load_arguments.h"
#include "server/model/import_report.h"
#include "server/model/write_glb.h"

namespace farfield {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr const char* kFooter = R"(Examples:
  farfield-scene info clinic.glb
  farfield-scene info tile.city.json --json
  farfield-scene info delft.obj --up z --shift -84900,0,447600
  farfield-scene info engine.stl --units 0.001
  farfield-scene info pipes:1000000:1
  farfield-scene generate city:500000:7 -o city.glb

Exit codes: 0 done, 1 failed, 2 wrong usage.)";

void add_info(CLI::App& app, SceneInfoOptions& options, LoadArguments& load) {
  CLI::App* info =
      app.add_subcommand("info", "Load a scene and report triangles, materials, bounds and what was dropped");
  info->add_option("SCENE", options.scene,
                   "Model file (.glb .gltf .obj .ply .stl .off .dae .ac .ifc .city.json .jsonl) or KIND:TRIANGLES:SEED")
      ->required();
  load.add_to(*info);
  info->add_flag("--json", options.is_json, "Report as JSON");
}

void add_generate(CLI::App& app, SceneGenerateOptions& options) {
  CLI::App* generate = app.add_subcommand("generate", "Generate a scene and write it as binary glTF");
  generate->add_option("SCENE", options.scene, "KIND:TRIANGLES:SEED with a kind of pipes, city, statues or house")
      ->required();
  generate->add_option("-o,--output", options.output, "File to write, ending in .glb")->required();
  generate->add_flag("--json", options.is_json, "Report as JSON");
}

void write_report(const ImportReport& report, bool is_json, std::ostream& out) {
  out << (is_json ? report_json(report) : report_text(report)) << std::flush;
}

}  // namespace

Status run_scene_info(const SceneInfoOptions& options, std::ostream& out) {
  const Clock::time_point start = Clock::now();
  const Result<Model> model = load_model(options.scene, options.load);
  if (!model) return tl::unexpected(model.error());
  write_report(make_import_report(options.scene, *model, options.load, seconds_since(start)), options.is_json, out);
  if (!out) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  return {};
}

Status run_scene_generate(const SceneGenerateOptions& options, std::ostream& out) {
  if (options.output.extension() != ".glb") {
    return fail(ErrorCode::kInvalidArgument, "{}: only .glb is written; end the name in .glb", options.output.string());
  }
  if (std::count(options.scene.begin(), options.scene.end(), ':') != 2) {
    return fail(ErrorCode::kInvalidArgument, "{}: name a scene to generate as KIND:TRIANGLES:SEED, as in city:500000:7",
                options.scene);
  }
  if (const Status status = check_file_can_be_written(options.output); !status) return status;
  const Clock::time_point start = Clock::now();
  const Result<Model> model = load_model(options.scene);
  if (!model) return tl::unexpected(model.error());
  if (const Status status = write_glb(*model, options.output); !status) return status;
  write_report(make_import_report(options.scene, *model, {}, seconds_since(start)), options.is_json, out);
  if (!out) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  return {};
}

int run_scene_tool(int argument_count, const char* const* arguments) {
  CLI::App app{"Look at models the way the Farfield server sees them, and generate test scenes.", "farfield-scene"};
  app.footer(kFooter);
  app.set_version_flag("--version", "farfield-scene " FARFIELD_VERSION);
  app.require_subcommand(1);
  SceneInfoOptions info;
  SceneGenerateOptions generate;
  LoadArguments load;
  add_info(app, info, load);
  add_generate(app, generate);
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, std::cout, std::cerr)) return *over;
  info.load = load.options();

  const bool is_info = app.got_subcommand("info");
  const Status status = is_info ? run_scene_info(info, std::cout) : run_scene_generate(generate, std::cout);
  if (status) return 0;
  complain(std::cerr, "farfield-scene", status.error().message);
  return status.error().code == ErrorCode::kInvalidArgument ? 2 : 1;
}

}  // namespace farfield

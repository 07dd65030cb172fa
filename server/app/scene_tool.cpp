// SPDX-License-Identifier: Apache-2.0
#include "server/app/scene_tool.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <ostream>
#include <vector>

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

void add_info(CLI::App& app, SceneInfoOptions& options, std::vector<double>& shift, unsigned& memory_gb) {
  CLI::App* info =
      app.add_subcommand("info", "Load a scene and report triangles, materials, bounds and what was dropped");
  info->add_option("SCENE", options.scene,
                   "Model file (.glb .gltf .obj .ply .stl .off .dae .ac .ifc .city.json .jsonl) or KIND:TRIANGLES:SEED")
      ->required();
  info->add_option("--units", options.load.metres_per_unit, "Metres per unit of the file (default 1)")
      ->check(CLI::Range(1e-9, 1e9));
  info->add_option("--up", options.load.up, "Axis that points up in the file (default y; z for CityJSON)")
      ->check(CLI::IsMember({"x", "y", "z"}));
  info->add_option("--shift", shift, "Metres added to every position after units and up, as X,Y,Z")
      ->delimiter(',')
      ->expected(3);
  info->add_option("--memory-gb", memory_gb, "Memory the import process may use (default 8)")
      ->check(CLI::Range(1, 1024));
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
  std::vector<double> shift;
  unsigned memory_gb = 8;
  add_info(app, info, shift, memory_gb);
  add_generate(app, generate);
  try {
    app.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    constexpr int kUsageExit = 2;
    return app.exit(error, std::cout, std::cerr) == 0 ? 0 : kUsageExit;
  }
  if (shift.size() == 3) info.load.shift = {shift[0], shift[1], shift[2]};
  info.load.memory_limit_bytes = std::size_t{memory_gb} << 30;

  const bool is_info = app.got_subcommand("info");
  const Status status = is_info ? run_scene_info(info, std::cout) : run_scene_generate(generate, std::cout);
  if (status) return 0;
  std::cerr << "farfield-scene: " << status.error().message << '\n';
  return status.error().code == ErrorCode::kInvalidArgument ? 2 : 1;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// The command line of farfield-server.
#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>

#include "server/app/byte_size.h"
#include "server/app/server_program.h"

namespace farfield {
namespace {

constexpr int kUsageExit = 2;
constexpr int kInterruptedExit = 130;

constexpr const char* kFooter = R"(Examples:
  farfield-server --scene clinic.glb
  farfield-server --scene plant=pipes:1000000:1 --scene town=tile.city.json --listen 0.0.0.0:7400
  farfield-server --scene delft.obj --up z --shift -84900,0,447600 --admin 127.0.0.1:7401

SIGTERM stops taking clients, tells those connected to come back, and ends.
Exit codes: 0 told to stop, 1 failed, 2 wrong usage, 130 interrupted.)";

struct RawOptions {
  std::vector<std::string> scenes;
  std::string listen = "127.0.0.1:7400", admin, memory = "4GiB";
  std::vector<double> shift;
  bool shows_version = false;
};

void add_options(CLI::App& app, RawOptions& raw, ServerProgramOptions& options) {
  app.add_option("--scene", raw.scenes, "Scene to serve, [NAME=]SCENE: a model file or KIND:TRIANGLES:SEED; repeatable")
      ->required()
      ->allow_extra_args(false);
  app.add_option("--listen", raw.listen, "HOST:PORT for clients; port 0 takes any free one and prints it")->capture_default_str();
  app.add_option("--admin", raw.admin, "HOST:PORT for /metrics, /healthz and /readyz (default: off)");
  app.add_option("--memory", raw.memory, "Bound of the encoded tiles kept in memory")->capture_default_str();
  app.add_option("--threads", options.threads, "Threads that make tiles (default: one per processor)")->check(CLI::Range(1, 1024));
  app.add_option("--units", options.load.metres_per_unit, "Metres per unit of the model files (default: what they say, else 1)")
      ->check(CLI::Range(1e-9, 1e9));
  app.add_option("--up", options.load.up, "Axis that points up in the model files (default y; z for CityJSON)")
      ->check(CLI::IsMember({"x", "y", "z"}));
  app.add_option("--shift", raw.shift, "Metres added to every position after units and up, as X,Y,Z")->delimiter(',')->expected(3);
  app.add_flag("--json", options.is_json, "Where it listens, and the log, as JSON lines");
  app.add_flag("--verbose", options.is_verbose, "Log every session");
}

Status fill(const RawOptions& raw, ServerProgramOptions& options) {
  for (const std::string& text : raw.scenes) {
    Result<SceneArgument> scene = parse_scene_argument(text);
    if (!scene) return tl::unexpected(scene.error());
    options.scenes.push_back(std::move(*scene));
  }
  const Result<Endpoint> listen = parse_endpoint(raw.listen);
  if (!listen) return fail_within("--listen", listen.error());
  options.listen = *listen;
  if (!raw.admin.empty()) {
    const Result<Endpoint> admin = parse_endpoint(raw.admin);
    if (!admin) return fail_within("--admin", admin.error());
    options.admin = *admin;
  }
  const Result<std::size_t> memory = parse_byte_size(raw.memory);
  if (!memory) return fail_within("--memory", memory.error());
  options.memory_bytes = *memory;
  if (raw.shift.size() == 3) options.load.shift = {raw.shift[0], raw.shift[1], raw.shift[2]};
  return {};
}

}  // namespace

int run_server_program(int argument_count, const char* const* arguments) {
  CLI::App app{"Serve scenes to Farfield clients.", "farfield-server"};
  app.footer(kFooter);
  app.set_version_flag("--version", "farfield-server " FARFIELD_VERSION);
  RawOptions raw;
  ServerProgramOptions options;
  add_options(app, raw, options);
  try {
    app.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error, std::cout, std::cerr) == 0 ? 0 : kUsageExit;
  }
  Status filled = fill(raw, options);
  const Result<int> signal = filled ? run_server(options) : tl::unexpected(filled.error());
  if (signal) return *signal == SIGINT ? kInterruptedExit : 0;
  std::cerr << "farfield-server: " << signal.error().message << '\n';
  return signal.error().code == ErrorCode::kInvalidArgument ? kUsageExit : 1;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// The command line of farfield-server.
#include <csignal>
#include <iostream>

#include "common/base/command_line.h"
#include "common/base/byte_size.h"
#include "common/base/duration.h"
#include "server/app/load_arguments.h"
#include "server/app/quality_arguments.h"
#include "server/app/server_program.h"
#include "server/app/store_arguments.h"

namespace farfield {
namespace {

constexpr int kUsageExit = 2;
constexpr int kInterruptedExit = 130;

constexpr const char* kFooter = R"(Examples:
  farfield-server --scene clinic.glb
  farfield-server --scene plant=pipes:1000000:1 --scene town=tile.city.json --listen 0.0.0.0:7400
  farfield-server --scene plant.glb --store /var/cache/farfield --store-bytes 100GiB
  farfield-server --scene plant.glb --redis cache.example:6379     # one of several that share what they make
  farfield-server --scene plant.glb --tls-listen 0.0.0.0:7443 --tls-cert fullchain.pem --tls-key key.pem --tokens tokens
  farfield-server --scene delft.obj --up z --shift -84900,0,447600 --admin 127.0.0.1:7401

SIGHUP reads certificate, key and tokens again.
SIGTERM stops taking clients, tells those connected to come back, and ends.
Exit codes: 0 told to stop, 1 failed, 2 wrong usage, 130 interrupted.)";

struct RawOptions {
  std::vector<std::string> scenes;
  std::string listen, admin, memory = "4GiB", drain_accept = "5s";
  StoreArguments stores;
  LoadArguments load;
  SecurityArguments security;
  bool shows_version = false;
};

void add_options(CLI::App& app, RawOptions& raw, ServerProgramOptions& options) {
  app.add_option("--scene", raw.scenes, "Scene to serve, [NAME=]SCENE: a model file or KIND:TRIANGLES:SEED; repeatable")
      ->required()
      ->allow_extra_args(false);
  app.add_option("--listen", raw.listen, "HOST:PORT for clients, unencrypted; port 0 takes any free one and prints it (default: 127.0.0.1:7400, and with --tls-listen none)");
  raw.security.add_to(app);
  app.add_option("--admin", raw.admin, "HOST:PORT for /metrics, /healthz and /readyz (default: off)");
  app.add_option("--sessions", options.sessions, "Viewers at a time; more are told when to come back")
      ->check(whole_number_between(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--drain-accept", raw.drain_accept, "How long a server with --admin still takes viewers after SIGTERM, while /readyz says no")->capture_default_str();
  app.add_option("--memory", raw.memory, "Bound of the encoded tiles kept in memory")->capture_default_str();
  raw.stores.add_to(app);
  app.add_option("--threads", options.threads, "Threads that make tiles (default: one per processor)")->check(whole_number_between(1, 1024));
  app.add_option("--cast-nice", options.cast_nice, "How much these threads give way to those that serve: 10 on a machine of the server's own")
      ->check(whole_number_between(0, 19))
      ->capture_default_str();
  raw.load.add_to(app);
  add_quality_options(app, options.settings);
  app.add_flag("--json", options.is_json, "Where it listens, and the log, as JSON lines");
  app.add_flag("--verbose", options.is_verbose, "Log every session");
}

Status fill(const RawOptions& raw, ServerProgramOptions& options) {
  for (const std::string& text : raw.scenes) {
    Result<SceneArgument> scene = parse_scene_argument(text);
    if (!scene) return tl::unexpected(scene.error());
    options.scenes.push_back(std::move(*scene));
  }
  Result<SecurityOptions> security = raw.security.options();
  if (!security) return tl::unexpected(security.error());
  options.security = std::move(*security);
  if (!raw.listen.empty()) {
    const Result<Endpoint> listen = parse_endpoint(raw.listen);
    if (!listen) return fail_within("--listen", listen.error());
    options.listen = *listen;
  } else if (!options.security.tls_listen) {
    options.listen = Endpoint{};
  }
  if (!raw.admin.empty()) {
    const Result<Endpoint> admin = parse_endpoint(raw.admin);
    if (!admin) return fail_within("--admin", admin.error());
    options.admin = *admin;
  }
  const Result<std::size_t> memory = parse_byte_size(raw.memory);
  if (!memory) return fail_within("--memory", memory.error());
  options.memory_bytes = *memory;
  Result<StoreOptions> stores = raw.stores.options();
  if (!stores) return tl::unexpected(stores.error());
  options.stores = std::move(*stores);
  const Result<std::chrono::seconds> drain_accept = parse_duration(raw.drain_accept);
  if (!drain_accept) return fail_within("--drain-accept", drain_accept.error());
  options.drain_accept = *drain_accept;
  options.load = raw.load.options();
  ImpostorSettings& settings = options.settings;
  if (settings.face_tiles == 0) settings.face_tiles = face_tiles_for(settings.display, settings.kappa);
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
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, std::cout, std::cerr)) return *over;
  Status filled = fill(raw, options);
  const Result<int> signal = filled ? run_server(options) : tl::unexpected(filled.error());
  if (signal) return *signal == SIGINT ? kInterruptedExit : 0;
  complain(std::cerr, "farfield-server", signal.error().message);
  return signal.error().code == ErrorCode::kInvalidArgument ? kUsageExit : 1;
}

}  // namespace farfield

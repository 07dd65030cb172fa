// SPDX-License-Identifier: Apache-2.0
#include "server/app/server_program.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <asio/io_context.hpp>
#include <asio/signal_set.hpp>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>
#include <unordered_set>

#include "common/net/connect.h"
#include "server/admin/admin_server.h"
#include "server/admin/server_metrics.h"
#include "server/app/supervisor.h"
#include "server/store/memory_tile_store.h"

namespace farfield {
namespace {

constexpr std::chrono::seconds kDrainGrace{5};
// They wait for the disk rather than for a processor.
constexpr int kPromptThreads = 4;

/// One line per event on stderr, as text or as JSON.
class EventLog {
 public:
  explicit EventLog(bool is_json)
      : is_json_(is_json), logger_("farfield-server", std::make_shared<spdlog::sinks::stderr_sink_mt>()) {
    logger_.set_pattern(is_json ? R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","message":%v})"
                                : "%Y-%m-%d %H:%M:%S.%e %v");
  }
  void write(const std::string& line) {
    constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
    logger_.info(is_json_ ? nlohmann::json(line).dump(-1, ' ', false, kReplace) : line);
  }

 private:
  bool is_json_;
  spdlog::logger logger_;
};

std::string metrics_page(const Server& server, const std::vector<std::shared_ptr<MeasuredCellService>>& services) {
  PrometheusText out;
  write_metrics(out, server.metrics());
  write_metrics(out, services);
  write_process_metrics(out);
  return out.text();
}

/// Said before minutes are spent on loading; the sockets are opened for good when there is something to serve.
Status check_addresses(const ServerProgramOptions& options) {
  asio::io_context context{1};
  for (const std::optional<Endpoint>& endpoint : {options.listen, options.security.tls_listen}) {
    if (!endpoint) continue;
    if (const auto listening = listen_at(context.get_executor(), *endpoint); !listening) return tl::unexpected(listening.error());
  }
  if (!options.admin) return {};
  const auto listening = listen_at(context.get_executor(), *options.admin);
  if (!listening) return fail_within("--admin", listening.error());
  return {};
}

void print_where(const ServerProgramOptions& options, const Server& server, const AdminServer* admin, double ready_seconds) {
  const std::optional<Endpoint> secure = server.tls_endpoint();
  if (options.is_json) {
    nlohmann::json where{{"ready_s", ready_seconds}};
    if (options.listen) where["listening"] = to_string(server.endpoint());
    if (secure) where["listening_tls"] = to_string(*secure);
    if (admin) where["admin"] = to_string(admin->endpoint());
    std::cout << where.dump() << std::endl;
    return;
  }
  if (options.listen) std::cout << "listening at " << to_string(server.endpoint()) << std::endl;
  if (secure) std::cout << "listening for TLS at " << to_string(*secure) << std::endl;
  if (admin) std::cout << "admin at " << to_string(admin->endpoint()) << std::endl;
}

Result<std::vector<std::shared_ptr<MeasuredCellService>>> build_services(const ServerProgramOptions& options,
                                                                         const std::shared_ptr<PreparedScenes>& prepared, EventLog& log) {
  ServiceOptions service_options;
  service_options.load = options.load;
  service_options.settings = options.settings;
  service_options.prepared = prepared;
  service_options.store = std::make_shared<MemoryTileStore>(options.memory_bytes);
  service_options.pool = std::make_shared<JobPool>(options.threads, JobPool::kDefaultQueueCapacity, steady_clock_seconds(), "cast", options.cast_nice);
  service_options.prompt_pool = std::make_shared<JobPool>(kPromptThreads, JobPool::kDefaultQueueCapacity, steady_clock_seconds(), "prompt");
  service_options.log = [&log](const std::string& line) { log.write(line); };
  Result<OpenStores> stores = open_stores(options.stores, service_options.log);
  if (!stores) return tl::unexpected(stores.error());
  service_options.blobs = std::move(stores->blobs), service_options.lease = std::move(stores->lease);
  std::vector<std::shared_ptr<MeasuredCellService>> services;
  for (const SceneArgument& scene : options.scenes) {
    Result<std::shared_ptr<MeasuredCellService>> service = build_service(scene, service_options);
    if (!service) return tl::unexpected(service.error());
    services.push_back(std::move(*service));
  }
  return services;
}

/// Blocks until one of the signals has come. A second one during the drain ends the process at once.
int wait_for_signal(asio::io_context& context, asio::signal_set& signals) {
  int received = 0;
  signals.async_wait([&](const asio::error_code&, int signal) {
    received = signal;
    context.stop();  // SIGHUP is waited for still
  });
  context.run();
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  return received;
}

/// What is allowed, and seldom meant.
std::vector<std::string> security_warnings(const ServerProgramOptions& options) {
  std::vector<std::string> warnings;
  if (geteuid() == 0) warnings.emplace_back("runs as root, which nothing here needs: start it as a user of its own");
  if (options.listen && !is_loopback(*options.listen) && !options.security.tokens.empty()) {
    warnings.push_back(fmt::format("--listen {}: access tokens and the model travel readable by all in between: use --tls-listen", to_string(*options.listen)));
  }
  if (options.admin && !is_loopback(*options.admin)) {
    warnings.push_back(fmt::format("--admin {} asks nobody who they are, and is open to other machines", to_string(*options.admin)));
  }
  std::error_code error;
  const auto permissions = std::filesystem::status(options.security.tls.key, error).permissions();
  if (options.security.tls_listen && !error && (permissions & std::filesystem::perms::others_read) != std::filesystem::perms::none) {
    warnings.emplace_back("--tls-key: every user of this machine can read the key: chmod o-r");
  }
  return warnings;
}

/// Reads what may change while the server runs whenever SIGHUP comes.
void reload_on_hangup(asio::signal_set& hangup, TlsServer* tls, TokenRegister* tokens, EventLog& log) {
  hangup.async_wait([&hangup, tls, tokens, &log](const asio::error_code& error, int) {
    if (error) return;
    if (tls) {
      const Status read = tls->reload();
      log.write(read ? "the certificate was read again: new connections get it" : "the certificate stays as it was: " + read.error().message);
    }
    if (tokens) {
      const Status read = tokens->reload();
      log.write(read ? fmt::format("the list of tokens was read again: {} of them", tokens->size()) : "the list of tokens stays as it was: " + read.error().message);
    }
    reload_on_hangup(hangup, tls, tokens, log);
  });
}

/// Said before minutes are spent on loading.
Status check_names(const std::vector<SceneArgument>& scenes) {
  std::unordered_set<std::string> names;
  for (const SceneArgument& scene : scenes) {
    if (names.insert(scene.name).second) continue;
    return fail(ErrorCode::kInvalidArgument, "two scenes are called '{}': give one another name with NAME=SCENE", scene.name);
  }
  return {};
}

}  // namespace

Result<int> run_server(const ServerProgramOptions& options) {
  if (const Status unique = check_names(options.scenes); !unique) return tl::unexpected(unique.error());
  if (const Status free = check_addresses(options); !free) return tl::unexpected(free.error());
  const auto start = std::chrono::steady_clock::now();
  std::shared_ptr<TlsServer> tls;
  if (options.security.tls_listen) {
    Result<std::shared_ptr<TlsServer>> loaded = TlsServer::load(options.security.tls);
    if (!loaded) return tl::unexpected(loaded.error());
    tls = std::move(*loaded);
  }
  std::shared_ptr<TokenRegister> tokens;
  if (!options.security.tokens.empty()) {
    Result<std::shared_ptr<TokenRegister>> loaded = TokenRegister::load(options.security.tokens);
    if (!loaded) return fail_within("--tokens", loaded.error());
    tokens = std::move(*loaded);
  }
  EventLog log(options.is_json);
  asio::io_context context{1};
  asio::signal_set hangup(context, SIGHUP);  // from here on it ends nothing, not even while scenes are loaded
  const auto prepared = prepared_bytes(options.stores) == 0 ? nullptr : std::make_shared<PreparedScenes>(options.stores.folder, prepared_bytes(options.stores));
  const auto services = build_services(options, prepared, log);
  if (!services) return tl::unexpected(services.error());

  for (const std::string& warning : security_warnings(options)) log.write("warning: " + warning);
  ServerOptions server_options;
  server_options.listen = options.listen;
  server_options.limits.sessions = options.sessions;
  server_options.tls_listen = options.security.tls_listen;
  server_options.tls = tls;
  server_options.tokens = tokens;
  server_options.limits.per_address = options.security.per_address;
  if (options.is_verbose) server_options.log = [&log](const std::string& line) { log.write(line); };
  asio::signal_set signals(context, SIGINT, SIGTERM);
  reload_on_hangup(hangup, tls.get(), tokens.get(), log);
  const Result<std::unique_ptr<Server>> server = Server::start(server_options, {services->begin(), services->end()});
  if (!server) return tl::unexpected(server.error());

  std::unique_ptr<AdminServer> admin;
  if (options.admin) {
    AdminPages pages{[&] { return metrics_page(**server, *services); }, [&] { return (*server)->why_not_ready(); }};
    Result<std::unique_ptr<AdminServer>> started = AdminServer::start(*options.admin, std::move(pages));
    if (!started) return tl::unexpected(started.error());
    admin = std::move(*started);
  }
  const double ready_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  log.write(fmt::format("ready {:.2f} s after the start", ready_seconds));
  print_where(options, **server, admin.get(), ready_seconds);
  if (!std::cout) log.write("warning: where it listens cannot be written to the output");
  const Supervisor supervisor = Supervisor::from_environment();
  supervisor.ready(fmt::format("serves {} scenes at {}", services->size(), to_string((*server)->endpoint())));
  const auto pings = supervisor.keep_pinging([&] { return (*server)->answers_within(std::chrono::seconds(5)); });
  const int signal = wait_for_signal(context, signals);
  supervisor.stopping();
  if (options.admin && options.drain_accept.count() > 0) {
    // A balancer needs some checks until it sends nobody any more; whoever it sends meanwhile would only be sent back.
    log.write(fmt::format("draining: not ready from now on, viewers are taken for {} s more", options.drain_accept.count()));
    (*server)->announce_drain();
    std::this_thread::sleep_for(options.drain_accept);
  }
  log.write("stopping: clients are told to come back later");
  (*server)->drain("the server is shutting down", kDrainGrace);
  return signal;
}

}  // namespace farfield

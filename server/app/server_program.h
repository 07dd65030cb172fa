// SPDX-License-Identifier: Apache-2.0
// farfield-server: serves scenes until it is told to stop. Data on stdout (where it listens), talk on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/impostor/settings.h"
#include "server/app/build_service.h"
#include "server/app/open_stores.h"
#include "server/app/security_arguments.h"
#include "server/session/server.h"

namespace farfield {

struct ServerProgramOptions {
  std::vector<SceneArgument> scenes;
  std::optional<Endpoint> listen;  // plain
  SecurityOptions security;
  std::optional<Endpoint> admin;
  std::size_t memory_bytes = std::size_t{4} << 30;  // of encoded tiles
  StoreOptions stores;                              // behind memory
  int threads = 0;                                  // that make tiles; 0: one per processor
  int cast_nice = 0;                                // of these threads
  std::size_t sessions = 1000;                      // viewers at a time; more are told when to come back
  std::chrono::seconds drain_accept{5};             // with `admin`: how long those who come while it drains are still served
  LoadOptions load;
  ImpostorSettings settings;
  bool is_json = false;
  bool is_verbose = false;
};

/// Loads, serves, and returns when SIGINT or SIGTERM has come and clients are drained. Errors: what kept it from
/// serving. Returns: the signal.
Result<int> run_server(const ServerProgramOptions& options);

/// The whole program. Returns: 0 told to stop (SIGTERM), 1 failed (one line on stderr), 2 wrong usage, 130 interrupted
/// (SIGINT).
int run_server_program(int argument_count, const char* const* arguments);

}  // namespace farfield

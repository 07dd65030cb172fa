// SPDX-License-Identifier: Apache-2.0
// The measured client as a child process, seen from the benchmark.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/math/camera.h"
#include "common/net/endpoint.h"
#include "server/schedule/worker_pool.h"

namespace farfield::bench {

/// What the two processes say to each other, a line each, on the client's standard output and input. Between kQuiet's
/// answer and kGoOn the server makes nothing: on one machine its rays would be counted as the client's frame time.
inline constexpr const char* kQuiet = "quiet";
inline constexpr const char* kIsQuiet = "is quiet";
inline constexpr const char* kGoOn = "go on";
/// The client's last line if it fails: this, and why.
inline constexpr std::string_view kFailed = "failed: ";

struct ClientRun {
  Endpoint endpoint;
  std::string renderer, mode;
  std::filesystem::path folder;  // for the dumped frames
  std::filesystem::path trace;
  std::size_t frames = 0;        // sampled from it
  int samples = 0;               // per pixel; 0: the renderer's choice
};

/// Starts this program again as a client and waits for it. `pool` pauses while the client asks for quiet.
/// Returns: the JSON object that is the last line it prints. Errors: kUnavailable, with what the client said.
Result<nlohmann::json> run_client(const Display& display, const ClientRun& run, JobPool& pool);

}  // namespace farfield::bench

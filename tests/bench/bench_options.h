// SPDX-License-Identifier: Apache-2.0
// What farfield-bench is asked to measure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/impostor/settings.h"
#include "common/math/camera.h"
#include "common/net/link_model.h"
#include "server/model/load_model.h"

namespace farfield::bench {

/// A method to be run once for each of several values of a knob.
struct Sweep {
  std::string method, knob;
  std::vector<double> values;  // in the order given, at least one
};

struct BenchOptions {
  std::string scene;
  std::filesystem::path trace;
  std::vector<std::string> methods;
  std::vector<Sweep> sweeps;
  Display display;
  std::size_t frames = 24;          // sampled evenly over the trace
  int truth_samples = 16;
  std::size_t border_pairs = 12;    // across borders of cells, and as many inside cells; 0: none
  std::string link = "none";
  LinkModel link_model;
  LoadOptions load;
  ImpostorSettings settings;
  int threads = 0;
  int client_samples = 0;  // 0: the renderer's choice
  bool is_realtime_wanted = true;
  bool explains = false;   // what was skipped and why, per cell
  std::filesystem::path json, plot, frames_folder, contact_sheet;
  bool prints_json = false;
};

/// One method's child process: a real client in a process of its own.
struct ClientRole {
  std::string endpoint, renderer, mode;
  std::filesystem::path trace, folder;
  std::size_t frames = 0;
  Display display;
  int samples = 1;
};

struct ParsedCommand {
  bool is_client = false;
  BenchOptions bench;
  ClientRole client;
};

/// Returns: what to do, or the exit code (help, version, or 2 with one line on stderr).
tl::expected<ParsedCommand, int> parse_command(int argc, const char* const* argv);

}  // namespace farfield::bench

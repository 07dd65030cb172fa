// SPDX-License-Identifier: Apache-2.0
// A simulated viewer: a whole client but for the screen, its path, and what it had to wait for.
//
// Latencies begin at the moment something was due, not when this program came round to it: connecting and the first picture when the viewer
// was due to arrive, a cell when the viewer entered it. What is never ready counts with the time it was waited for.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "client/load/latency_samples.h"
#include "client/load/walk_plan.h"
#include "client/session/client_core.h"

namespace farfield::client {

struct WalkerFigures {
  LatencySamples connect, first_picture;
  LatencySamples first_cell;          // from arrival to the first complete leaf set
  LatencySamples cell_ready;          // of every leaf entered after that; 0: it was there
  LatencySamples away;                // from losing the server to being back
  std::uint64_t never_connected = 0, never_ready = 0;  // of these, still waited for at the end
  std::map<std::string, std::uint64_t> errors;         // by kind
  ClientStatistics statistics;        // sums over clients; of gauges the last
  double seconds = 0;                 // connected, summed up

  void add(const WalkerFigures& other);
};

/// Belongs to one thread. Times are seconds of one steady clock.
class Walker {
 public:
  /// `index`: which of the plan's ways. The plan outlives it.
  Walker(ClientOptions options, const WalkPlan& plan, std::size_t index, double due_s);

  double due_s() const { return due_s_; }
  /// Begins to connect.
  void start();
  /// One frame of the viewer's, due at `due_s`: it goes to its place, and somewhat later looks at what it is shown there. What a client
  /// has already it shows after a message between its threads.
  void move(double due_s, double now_s);
  void look(double due_s, double now_s);
  bool is_streaming() const { return state_ == ClientState::kStreaming; }
  bool is_late() const { return late_since_s_.has_value(); }
  /// The end of what is measured; the destructor says goodbye. Returns: all it met.
  WalkerFigures finish(double now_s);
  /// So far.
  const WalkerFigures& figures() const { return figures_; }

 private:
  void follow_state(double now_s);

  const WalkPlan& plan_;
  const std::size_t index_;
  const double due_s_;
  std::unique_ptr<ClientCore> core_;
  std::optional<SceneDescription> scene_;
  std::optional<WalkPath> path_;
  Pose eye_;  // scene frame
  ClientState state_ = ClientState::kConnecting;
  double welcome_s_ = 0;
  std::optional<double> lost_s_, late_since_s_;
  bool has_picture_ = false, has_cell_ = false;
  CellId leaf_;
  WalkerFigures figures_;
};

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// A load test: viewers arrive at their times whatever the server does (an open model), walk, and leave together at the end.
//
//   arrivals ─▶ walkers (a client core each) ─▶ link model, one for all connections ─▶ server
//
// One thread makes every viewer's frames; each client core has its network and decoding threads besides.
#pragma once

#include <atomic>
#include <functional>

#include "client/load/walker.h"
#include "common/net/link_model.h"

namespace farfield::client {

struct LoadOptions {
  ClientOptions client;              // of every viewer
  std::size_t clients = 1;
  double arrivals_per_s = 0;         // 0: all at once
  double seconds = 30;               // from the first arrival to the end
  WalkOptions walk;
  double frames_per_second = 30;     // of a viewer
  LinkModel link;                    // of each viewer
  const std::atomic<bool>* is_interrupted = nullptr;
};

/// How it stands, about once a second.
struct LoadProgress {
  double seconds = 0;
  std::size_t arrived = 0, streaming = 0, late = 0;
};

struct LoadOutcome {
  WalkerFigures figures;             // of all viewers
  LatencySamples own_lag;            // of this program: how late it made the viewers' frames
  std::size_t arrived = 0;
  double seconds = 0;
  double own_cpu_s = 0;              // processor time of this process
  bool is_interrupted = false;
};

/// Blocks for options.seconds. Errors: what keeps it from beginning (a walk that cannot be read, no link).
Result<LoadOutcome> run_load(const LoadOptions& options, const std::function<void(const LoadProgress&)>& progress);

}  // namespace farfield::client

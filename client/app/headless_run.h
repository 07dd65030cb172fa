// SPDX-License-Identifier: Apache-2.0
// The front end without a screen: replays a trace through a client core and a renderer, in real time or in lockstep.
//
// Real time: the trace's clock runs from the first frame on, whatever the network does; frames may be late.
// Lockstep: every frame waits for the complete leaf set of its leaf (design.md section 9).
#pragma once

#include <atomic>
#include <chrono>
#include <functional>

#include "client/app/run_report.h"
#include "client/frame/frame_renderer.h"
#include "client/session/client_core.h"
#include "common/trace/trace.h"

namespace farfield::client {

/// Takes every finished frame; an error ends the run.
using FrameSink = std::function<Status(const Frame& frame, std::size_t index)>;

struct HeadlessOptions {
  Trace trace;                       // world frame, at least one pose
  bool is_lockstep = false;
  std::size_t frames = 0;            // lockstep: spread evenly over the trace, 0: its own; real time: at most, 0: no bound
  double frames_per_second = 60;     // real time; 0: no bound
  std::chrono::milliseconds timeout{60000};  // lockstep: for one leaf set
  FrameSink sink;                    // may be empty
  const std::atomic<bool>* is_interrupted = nullptr;
};

struct HeadlessOutcome {
  RunReport report;
  Trace walked;                      // what was drawn, world frame
};

/// Requires: `core` has been welcomed; the calling thread may use `renderer`.
/// Errors: kUnavailable (lockstep: no complete leaf set in time), those of the sink.
Result<HeadlessOutcome> run_headless(ClientCore& core, FrameRenderer& renderer, const HeadlessOptions& options);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// What a run of the client amounted to, as text for people or JSON for programs.
#pragma once

#include <iosfwd>
#include <string>

#include "client/session/client_status.h"
#include "common/impostor/frame_promise.h"

namespace farfield::client {

struct RunReport {
  std::string scene;
  std::string renderer;             // "cpu" or "gl"
  bool is_lockstep = false;
  bool is_interrupted = false;
  double seconds = 0;               // from the first frame to the last
  double walked_m = 0;
  std::uint64_t frames = 0, late_frames = 0;
  std::uint64_t void_pixels = 0, crack_pixels = 0, pixels = 0;   // over all frames
  double median_frame_ms = 0, p99_frame_ms = 0;
  FramePromise promised;            // by certificates: means over the frames that showed a complete leaf set
  ClientStatistics statistics;
};

/// Bytes received after the first leaf set was complete.
std::uint64_t warm_bytes(const ClientStatistics& statistics);
void write_report(const RunReport& report, bool is_json, std::ostream& out);

}  // namespace farfield::client

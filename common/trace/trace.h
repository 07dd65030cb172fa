// SPDX-License-Identifier: Apache-2.0
// A recorded camera path: timed poses in the world, right-handed, +Y up, metres; cameras look along their -Z.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/math/box.h"
#include "common/math/camera.h"

namespace farfield {

struct TraceFrame {
  double time_s = 0;
  Pose pose;  // world frame
};

struct Trace {
  std::string scene;               // name of the scene it was made for; may be empty
  std::vector<TraceFrame> frames;  // times strictly increase

  double seconds() const { return frames.empty() ? 0 : frames.back().time_s - frames.front().time_s; }
};

/// The pose at `time_s`: positions linearly, rotations by slerp along the shorter arc; clamped to the first and last
/// frame. Requires: at least one frame. O(log n).
Pose pose_at(const Trace& trace, double time_s);

/// `count` frames evenly spaced over the trace's time, the first and last included.
/// One frame is the first; as many as the trace has are the trace itself, however it is spaced. Errors: kInvalidArgument if the trace is empty or count < 1.
Result<Trace> resampled(const Trace& trace, std::size_t count);

/// What a trace is, in numbers. Speeds are between successive frames.
struct TraceSummary {
  std::size_t frames = 0;
  double seconds = 0;
  double length_m = 0;
  double speed_mean_m_s = 0, speed_p95_m_s = 0;
  double turn_p95_rad_s = 0;
  Box bounds;  // of the positions, world
};
TraceSummary summarise(const Trace& trace);

/// Length of the path in metres.
double length_of(const Trace& trace);

}  // namespace farfield

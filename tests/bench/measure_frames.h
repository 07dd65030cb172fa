// SPDX-License-Identifier: Apache-2.0
// The loop that all methods share which draw in this process: every sampled pose drawn, timed and judged.
#pragma once

#include <chrono>
#include <functional>

#include "tests/bench/judge.h"
#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// What a method shows of one pose, and what that took.
struct DrawnFrame {
  JudgedFrame seen;
  double ms = 0;  // from the pose to the finished image in memory
  double triangles = kNone, samples = kNone;
};

/// Eye in the scene frame.
using DrawFrame = std::function<Result<DrawnFrame>(const Pose& eye)>;

/// Fills frame times, amounts drawn, errors and pictures; with cells, also the change of error across their borders, for
/// which more poses are drawn. The first pose is drawn once before it counts: shaders are
/// compiled and buffers moved on first use. Errors: those of `draw`.
Status measure_frames(const World& world, const DrawFrame& draw, MethodResult& result, bool has_cells = false);

using BenchClock = std::chrono::steady_clock;
inline double ms_since(BenchClock::time_point start) { return std::chrono::duration<double, std::milli>(BenchClock::now() - start).count(); }

}  // namespace farfield::bench

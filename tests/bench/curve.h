// SPDX-License-Identifier: Apache-2.0
// What a method costs against how wrong it is, over the values of one knob; and what can be said of such curves.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/bench/method_result.h"

namespace farfield::bench {

struct CurvePoint {
  double value = 0;                      // of the knob
  double frame_ms = kNone;               // median, lockstep
  double mbit_s = kNone;                 // lockstep, warm; NaN: the method streams nothing
  double flip = kNone, psnr_db = kNone;  // means
};

struct Curve {
  std::string method, knob;
  std::vector<CurvePoint> points;  // in the order of the sweep
};

CurvePoint point_of(double value, const MethodResult& result);

/// What an error is paid with.
struct CostAxis {
  const char* name;
  const char* unit;
  double CurvePoint::*cost;
};
inline constexpr CostAxis kCostAxes[] = {{"frame time", "ms", &CurvePoint::frame_ms}, {"bytes per second", "Mbit/s", &CurvePoint::mbit_s}};

/// The knee: where paying more begins to buy less. Both axes, cost and FLIP, are taken logarithmically and scaled so
/// that the curve's cheapest and dearest point span 0 to 1 in cost, and their errors 0 to 1 in FLIP; the knee is the
/// point farthest from the chord between those two, on the side of the origin.
/// Returns: its index in `points`; nothing if no point lies there, or fewer than three can be shown.
std::optional<std::size_t> knee_of(std::span<const CurvePoint> points, const CostAxis& axis);

/// The least cost at which one of the curves has at most this error. Between neighbouring points of a curve cost and
/// error are interpolated, both logarithmically. NaN: no curve gets that low.
double least_cost_for(std::span<const Curve> curves, const CostAxis& axis, double flip);

/// Does `mine` lie below and left of `theirs`: does each of their points have a point of mine (interpolated as above)
/// that is no worse in either? A line saying that it does, or a line for each of their points where it does not.
/// Empty if one of the two has nothing on this axis.
std::vector<std::string> dominance_report(const std::string& name, std::span<const Curve> mine, const Curve& theirs, const CostAxis& axis);

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "common/trace/trace.h"

#include <algorithm>
#include <cmath>

namespace farfield {
namespace {

double turn_between(const glm::dquat& a, const glm::dquat& b) {
  const glm::dquat turn = glm::conjugate(a) * b;
  // atan2 keeps small turns exact, where acos of the dot product loses half the digits.
  return 2.0 * std::atan2(std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z), std::abs(turn.w));
}

double percentile_95(std::vector<double> values) {
  if (values.empty()) return 0;
  const std::size_t rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(values.size()))) - 1;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

}  // namespace

Pose pose_at(const Trace& trace, double time_s) {
  const auto& frames = trace.frames;
  const auto after = std::upper_bound(frames.begin(), frames.end(), time_s,
                                      [](double t, const TraceFrame& frame) { return t < frame.time_s; });
  if (after == frames.begin()) return frames.front().pose;
  if (after == frames.end()) return frames.back().pose;
  const TraceFrame &a = *(after - 1), &b = *after;
  const double s = (time_s - a.time_s) / (b.time_s - a.time_s);
  return {a.pose.position + s * (b.pose.position - a.pose.position),
          glm::normalize(glm::slerp(a.pose.world_from_camera, b.pose.world_from_camera, s))};
}

Result<Trace> resampled(const Trace& trace, std::size_t count) {
  if (trace.frames.empty()) return fail(ErrorCode::kInvalidArgument, "trace has no frames to resample");
  if (count < 1) return fail(ErrorCode::kInvalidArgument, "a trace cannot be resampled to no frames: ask for at least 1");
  if (count == trace.frames.size()) return trace;
  Trace result;
  result.scene = trace.scene;
  if (trace.frames.size() == 1 || count == 1) {
    result.frames = {trace.frames.front()};
    return result;
  }
  result.frames.reserve(count);
  const double start = trace.frames.front().time_s, last = static_cast<double>(count - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s =
        i + 1 == count ? trace.frames.back().time_s : start + trace.seconds() * (static_cast<double>(i) / last);
    result.frames.push_back({time_s, pose_at(trace, time_s)});
  }
  return result;
}

double length_of(const Trace& trace) {
  double length = 0;
  for (std::size_t i = 1; i < trace.frames.size(); ++i) {
    length += glm::distance(trace.frames[i - 1].pose.position, trace.frames[i].pose.position);
  }
  return length;
}

TraceSummary summarise(const Trace& trace) {
  TraceSummary summary;
  summary.frames = trace.frames.size();
  summary.seconds = trace.seconds();
  summary.length_m = length_of(trace);
  if (summary.seconds > 0) summary.speed_mean_m_s = summary.length_m / summary.seconds;
  std::vector<double> speeds, turns;
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    const TraceFrame& frame = trace.frames[i];
    summary.bounds.include(frame.pose.position);
    if (i == 0) continue;
    const TraceFrame& before = trace.frames[i - 1];
    const double step_s = frame.time_s - before.time_s;
    speeds.push_back(glm::distance(before.pose.position, frame.pose.position) / step_s);
    turns.push_back(turn_between(before.pose.world_from_camera, frame.pose.world_from_camera) / step_s);
  }
  summary.speed_p95_m_s = percentile_95(std::move(speeds));
  summary.turn_p95_rad_s = percentile_95(std::move(turns));
  return summary;
}

}  // namespace farfield

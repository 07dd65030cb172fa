// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/video_schedule.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/quaternion_exponential.hpp>

#include "common/predict/motion_filter.h"
#include "tests/bench/distribution.h"

namespace farfield::bench {
namespace {

constexpr double kSteadySeconds = 1;
constexpr double kServerSeconds = 0.010;
constexpr double kPoseInterval = 1.0 / 60;
constexpr double kTurnSeconds = 0.05;
constexpr double kLargestMargin = 30 * 3.14159265358979323846 / 180;

/// The server's idea of where the viewer will be; asked for ever later times.
class Predictor {
 public:
  Predictor(const Trace& trace, double delay_s)
      : trace_(trace), delay_s_(delay_s), next_(trace.frames.front().time_s - kSteadySeconds - delay_s) {}

  Pose at(double shown_s) {
    if (!(delay_s_ > 0)) return pose_at(trace_, shown_s);
    const double known_s = shown_s - delay_s_;
    for (; next_ <= known_s; next_ += kPoseInterval) filter_.update(pose_at(trace_, next_).position, next_);
    const Pose last = pose_at(trace_, known_s), before = pose_at(trace_, known_s - kTurnSeconds);
    Pose pose = last;
    if (filter_.has_position()) pose.position = filter_.predict(shown_s - filter_.time_s()).position;
    glm::dquat turn = glm::normalize(last.world_from_camera * glm::conjugate(before.world_from_camera));
    if (turn.w < 0) turn = -turn;  // the shorter way round
    pose.world_from_camera = glm::normalize(glm::pow(turn, delay_s_ / kTurnSeconds) * last.world_from_camera);
    return pose;
  }

 private:
  const Trace& trace_;
  const double delay_s_;
  double next_;
  MotionFilter filter_;
};

double angle_between(const glm::dquat& a, const glm::dquat& b) {
  const glm::dquat turn = glm::conjugate(a) * b;
  return 2 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w));
}

int even(double size) {
  return 2 * static_cast<int>(std::ceil(size / 2));
}

}  // namespace

Display VideoSchedule::rendered(const Display& display) const {
  const double pitch = display.pixel_pitch();
  // tan(atan(x)) is x but for rounding, a few parts in 10^16 of some thousand pixels, which must not add two pixels where
  // there is no margin.
  constexpr double kRounding = 1e-6;
  const auto wider = [&](int pixels) { return even(2 * std::tan(std::atan(0.5 * pixels * pitch) + margin_rad) / pitch - kRounding); };
  Display wide{wider(display.width), wider(display.height)};
  wide.fovy_rad = 2 * std::atan(0.5 * pitch * wide.height);
  return wide;
}

double video_delay_s(const LinkModel& link) {
  if (link.is_none()) return 0;
  return 2 * (link.delay.count() + 0.5 * link.jitter.count()) + kServerSeconds;
}

VideoSchedule make_video_schedule(const Trace& trace, std::size_t frames, double pictures_per_second, double delay_s) {
  VideoSchedule schedule;
  const double begin = trace.frames.front().time_s;
  constexpr double kRounding = 1e-6;  // half a second at 30 Hz is 15 pictures, whatever rounding makes of it
  const double spacing = frames > 1 && trace.seconds() > 0 ? trace.seconds() / static_cast<double>(frames - 1) : 1 / pictures_per_second;
  const auto per_frame = static_cast<long>(std::max(1.0, std::ceil(spacing * pictures_per_second - kRounding)));
  schedule.interval_s = spacing / static_cast<double>(per_frame);
  const auto steady = static_cast<long>(std::ceil(kSteadySeconds / schedule.interval_s));
  Predictor predictor(trace, delay_s);
  std::vector<double> angles;
  const long last = static_cast<long>(frames - 1) * per_frame;
  bool was_needed = false;
  for (long step = -steady; step <= last; ++step) {
    const long next_judged = step <= 0 ? 0 : (step + per_frame - 1) / per_frame * per_frame;
    const bool is_needed = next_judged - step <= steady;
    if (is_needed) {
      const double shown_s = begin + schedule.interval_s * static_cast<double>(step);
      VideoPicture picture{predictor.at(shown_s), pose_at(trace, shown_s), !was_needed, step < 0};
      if (next_judged == step) picture.judged = static_cast<int>(step / per_frame);
      if (step >= 0) angles.push_back(angle_between(picture.predicted.world_from_camera, picture.shown.world_from_camera));
      schedule.pictures.push_back(picture);
    }
    was_needed = is_needed;
  }
  schedule.margin_rad = delay_s > 0 ? std::min(kLargestMargin, percentile(angles, 0.99)) : 0;
  return schedule;
}

}  // namespace farfield::bench

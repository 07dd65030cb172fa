// SPDX-License-Identifier: Apache-2.0
#include "client/session/pose_gate.h"

#include <algorithm>
#include <cmath>

namespace farfield::client {
namespace {

constexpr double kSmallestMovePixels = 0.1;
/// A movement has ended when no pose has differed for this long: six frames at the full pose rate.
constexpr double kRestAfterSeconds = 0.1;

double turn_between(const glm::dquat& a, const glm::dquat& b) {
  // |a·b| = cos(angle/2); through the chord, because acos loses all small angles.
  const glm::dquat nearer = glm::dot(a, b) < 0 ? -b : b;
  return 4.0 * std::asin(std::min(1.0, 0.5 * glm::length(a - nearer)));
}

}  // namespace

PoseGate::PoseGate(const CellGrid& grid, double kappa, const Display& display, double poses_per_second)
    : grid_(grid),
      smallest_move_m_(kSmallestMovePixels * display.pixel_pitch() * kappa * grid.finest_side_m),
      smallest_turn_rad_(display.pixel_pitch()),
      interval_s_(1.0 / poses_per_second) {}

bool PoseGate::differs(const Pose& pose, Lacks lacks) const {
  return glm::distance(pose.position, last_->pose.position) > smallest_move_m_ ||
         turn_between(pose.world_from_camera, last_->pose.world_from_camera) > smallest_turn_rad_ ||
         grid_.cell_at(pose.position, 0) != grid_.cell_at(last_->pose.position, 0) ||
         (lacks.usable_view && !last_->lacks.usable_view) || lacks.leaf_set != last_->lacks.leaf_set;
}

PoseGate::Decision PoseGate::decide(const Pose& pose, Lacks lacks, double now_s) const {
  if (!last_) return {true, {}};
  const bool is_moving = differs(pose, lacks);
  if (!is_moving && last_->is_rest) return {};
  const double due_s = last_->time_s + (is_moving ? interval_s_ : std::max(interval_s_, kRestAfterSeconds));
  if (now_s >= due_s) return {true, {}};
  return {false, due_s - now_s};
}

void PoseGate::note_sent(const Pose& pose, Lacks lacks, double now_s) {
  const bool is_rest = last_ && !differs(pose, lacks);
  last_ = Sent{pose, lacks, now_s, is_rest};
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/prefetch_planner.h"

#include <algorithm>
#include <cmath>

namespace farfield {

PrefetchPlanner::PrefetchPlanner(const CellGrid& grid, const PrefetchSettings& settings)
    : grid_(grid), settings_(settings), motion_(settings.motion) {}

bool PrefetchPlanner::is_moving() const {
  const double speed = glm::length(motion_.velocity());
  const bool gets_somewhere = speed * settings_.horizon_s > settings_.standing_sides * grid_.finest_side_m;
  // A velocity far below its own uncertainty is no direction: the state after a start or a sharp turn.
  return gets_somewhere && speed > 0.5 * motion_.velocity_sigma_m_s();
}

void PrefetchPlanner::note_heading(MotionFilter::Outcome outcome, bool moving) {
  const bool had_heading = glm::dot(heading_, heading_) > 0.5;  // unit or zero
  if (!moving || outcome == MotionFilter::Outcome::kStarted) {
    heading_changed_ = had_heading;
    heading_ = glm::dvec3(0);
    return;
  }
  const glm::dvec3 direction = glm::normalize(motion_.velocity());
  heading_changed_ = had_heading && glm::dot(direction, heading_) < std::cos(settings_.turn_rad);
  if (!had_heading || heading_changed_) heading_ = direction;
}

std::vector<PrefetchTarget> PrefetchPlanner::path_ahead(const glm::dvec3& from) const {
  // Two samples per finest side: a straight line cannot pass more than a corner of a cell between them.
  const double speed = glm::length(motion_.velocity());
  const double step_s =
      std::max(0.5 * grid_.finest_side_m / speed, settings_.horizon_s / (2.0 * settings_.max_targets));
  std::vector<PrefetchTarget> targets;
  CellId last = grid_.cell_at(from, 0);
  const CellId here = last;
  for (double ahead_s = settings_.first_s; ahead_s <= settings_.horizon_s; ahead_s += step_s) {
    const PredictedPosition predicted = motion_.predict(ahead_s);
    const CellId cell = grid_.cell_at(predicted.position, 0);
    if (cell == last || cell == here) continue;
    last = cell;
    targets.push_back({predicted.position, ahead_s, predicted.sigma_m});
    if (targets.size() >= static_cast<std::size_t>(std::max(settings_.max_targets, 0))) break;
  }
  return targets;
}

std::vector<PrefetchTarget> PrefetchPlanner::update(const Pose& pose, double time_s) {
  const MotionFilter::Outcome outcome = motion_.update(pose.position, time_s);
  if (outcome == MotionFilter::Outcome::kIgnored) {
    heading_changed_ = false;
    return {};
  }
  const bool moving = is_moving();
  note_heading(outcome, moving);
  if (!moving || !may_prefetch()) return {};
  return path_ahead(pose.position);
}

}  // namespace farfield

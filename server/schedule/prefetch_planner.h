// SPDX-License-Identifier: Apache-2.0
// Which viewpoints a viewer is about to reach, so that their leaves can be made and sent before they are needed.
//
//   pose ─▶ motion filter ─▶ straight path ahead ─▶ one viewpoint per finest cell on it, with the time to get there
//
// The session asks the cell service for each target's leaf with a prefetch priority, and keeps its tickets. What it
// must drop, and when it must stop, this class tells: see heading_changed() and may_prefetch().
// One per viewer, on the viewer's own strand; not thread-safe. Units: metres (scene frame), seconds of the client's
// clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "common/cells/cell_id.h"
#include "common/math/camera.h"
#include "common/predict/motion_filter.h"

namespace farfield {

struct PrefetchSettings {
  double horizon_s = 4.0;                // farther ahead the guess is worth less than the bytes
  double first_s = 0.25;                 // nearer than this, demand will come before the prefetch is done
  double standing_sides = 0.5;           // who moves less than this many finest sides within the horizon stands
  double turn_rad = 0.5235987755982988;  // 30 degrees: the path ahead is another one
  int max_targets = 32;                  // per pose; a fast flight is sampled more coarsely
  std::size_t max_outstanding_bytes = std::size_t{8} << 20;  // prefetched and not yet used
  MotionSettings motion;
};

struct PrefetchTarget {
  glm::dvec3 viewpoint{0};  // scene frame
  double seconds_until_needed = 0;
  double sigma_m = 0;  // how far off the viewer may be by then, along each axis
};

class PrefetchPlanner {
 public:
  /// `grid` gives the finest cells: the path is sampled so that none on it is missed (unless max_targets is hit).
  explicit PrefetchPlanner(const CellGrid& grid, const PrefetchSettings& settings = {});

  /// Takes a new pose. Returns: viewpoints ahead, soonest first, none in the finest cell the viewer is in, none
  /// while standing, just after a jump or a pause, while the motion is not known yet, or while !may_prefetch().
  /// Poses out of order change nothing and return nothing.
  std::vector<PrefetchTarget> update(const Pose& pose, double time_s);

  /// True if the last update() found the viewer on another path than before (turned, stopped or jumped): tickets for
  /// earlier targets should be dropped, except those of leaves listed again.
  bool heading_changed() const { return heading_changed_; }

  /// The byte budget of what was prefetched: the session adds what it began to send ahead of need, and takes off what
  /// was used, withdrawn or evicted.
  void add_outstanding(std::size_t bytes) { outstanding_bytes_ += bytes; }
  void remove_outstanding(std::size_t bytes) {
    outstanding_bytes_ -= bytes < outstanding_bytes_ ? bytes : outstanding_bytes_;
  }
  std::size_t outstanding_bytes() const { return outstanding_bytes_; }
  bool may_prefetch() const { return outstanding_bytes_ < settings_.max_outstanding_bytes; }

  const MotionFilter& motion() const { return motion_; }

 private:
  bool is_moving() const;
  void note_heading(MotionFilter::Outcome outcome, bool moving);
  std::vector<PrefetchTarget> path_ahead(const glm::dvec3& from) const;

  CellGrid grid_;
  PrefetchSettings settings_;
  MotionFilter motion_;
  glm::dvec3 heading_{0};  // unit direction the outstanding targets lie in; zero: there are none
  bool heading_changed_ = false;
  std::size_t outstanding_bytes_ = 0;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/session/leaf_tracker.h"

#include <algorithm>
#include <asio/post.hpp>
#include <utility>

#include "server/schedule/likely_ways.h"

namespace farfield {
namespace {

// Of one level and no more than some sides apart: a walk, not a jump.
bool is_close(const CellId& a, const CellId& b) {
  constexpr std::int64_t kReach = 16;
  const auto apart = [](std::int64_t p, std::int64_t q) { return p < q ? q - p : p - q; };
  return std::max({apart(a.x, b.x), apart(a.y, b.y), apart(a.z, b.z)}) <= kReach;
}

}  // namespace

LeafTracker::LeafTracker(asio::any_io_executor executor, std::shared_ptr<CellService> service,
                         std::shared_ptr<PayloadPump> pump, PrefetchPlanner& planner, const ServerLimits& limits,
                         SessionMetrics& metrics, Events events, std::shared_ptr<const void> keep_alive)
    : executor_(std::move(executor)),
      service_(std::move(service)),
      pump_(std::move(pump)),
      planner_(planner),
      metrics_(metrics),
      events_(std::move(events)),
      keep_alive_(std::move(keep_alive)),
      grid_{service_->scene().settings.finest_side_m},
      leaf_rate_(limits.leaves_per_second) {}

bool LeafTracker::is_in_current(const glm::dvec3& viewpoint) const {
  const std::shared_ptr<const LeafPlan>& current = pump_->current();
  return current && current->speaks_for(grid_, viewpoint);
}

bool LeafTracker::is_near_current(const glm::dvec3& viewpoint) const {
  const std::shared_ptr<const LeafPlan>& current = pump_->current();
  return current && grid_.box(current->leaf).grown(grid_.side_m(current->leaf.level)).contains(viewpoint);
}

void LeafTracker::move(const Pose& pose, double time_s, bool wants_fallback) {
  if (is_stopped_) return;
  pose_ = pose;
  if (wants_fallback) ask_fallback();
  demand();
  look_ahead(time_s);
}

void LeafTracker::move_again() {
  if (!is_stopped_ && pose_) demand();
}

void LeafTracker::demand() {
  const glm::dvec3& viewpoint = pose_->position;
  if (is_in_current(viewpoint)) {
    demanded_.clear();  // back before the answer came
    return;
  }
  const CellId finest = grid_.cell_at(viewpoint, 0);
  if (!demanded_.empty() && is_close(demanded_.back().finest, finest)) return;
  const auto now = TokenBucket::Clock::now();
  if (!leaf_rate_.take(now)) {
    ++metrics_.leaves_deferred;
    events_.on_wait(leaf_rate_.wait(now));
    return;
  }
  if (std::shared_ptr<const LeafPlan> known = pump_->announced_at(viewpoint)) {
    demanded_.clear();
    events_.on_enter(std::move(known));
    return;
  }
  if (const auto wait = events_.may_view ? events_.may_view(now) : TokenBucket::Clock::duration(0); wait.count() > 0) {
    ++metrics_.leaves_deferred;
    events_.on_wait(wait);
    return;
  }
  // What goes, goes only after the newest was asked, which may join the same work. The oldest is nearest to its answer.
  Question question{next_number_++, finest, 0.0, {}};
  question.ticket = ask(viewpoint, WorkPriority{-kPlanOverdue_s, 1.0f, false}, question.number);
  demanded_.push_back(std::move(question));
  if (demanded_.size() > kDemanded) demanded_.erase(demanded_.begin() + 1);
}

void LeafTracker::ask_fallback() {
  const glm::dvec3& viewpoint = pose_->position;
  const LeafPlan* sent = pump_->fallback();
  if (fallback_ || (sent && grid_.box(sent->leaf).contains(viewpoint))) return;
  if (pump_->is_current_complete() && is_in_current(viewpoint)) return;  // on its way to the client
  const std::uint64_t number = next_number_++;
  fallback_ = Question{number, grid_.cell_at(viewpoint, 0), 0.0, {}};
  const WorkPriority priority{-PayloadPump::kFallbackOverdue_s, 1.0f, false};
  Ticket ticket = service_->fallback(viewpoint, priority, [weak = weak_from_this(), number](LeafAnswer plan) {
    const std::shared_ptr<LeafTracker> self = weak.lock();
    if (!self) return;
    asio::post(self->executor_, [self, number, plan = std::move(plan)]() mutable {
      if (self->is_stopped_ || !self->fallback_ || self->fallback_->number != number) return;
      self->fallback_.reset();
      if (plan) self->pump_->show_fallback(std::move(*plan));
    });
  });
  fallback_->ticket = std::move(ticket);
}

Ticket LeafTracker::ask(const glm::dvec3& viewpoint, const WorkPriority& priority, std::uint64_t number) {
  return service_->leaf(viewpoint, priority, [weak = weak_from_this(), number](LeafAnswer plan) {
    const std::shared_ptr<LeafTracker> self = weak.lock();
    if (!self) return;
    asio::post(self->executor_, [self, number, plan = std::move(plan)]() mutable { self->receive(number, std::move(plan)); });
  });
}

void LeafTracker::receive(std::uint64_t number, LeafAnswer plan) {
  if (is_stopped_) return;
  const auto is_it = [&](const Question& question) { return question.number == number; };
  if (std::any_of(demanded_.begin(), demanded_.end(), is_it)) {
    receive_demanded(number, std::move(plan));
    return;
  }
  const auto ahead = std::find_if(ahead_.begin(), ahead_.end(), is_it);
  if (ahead == ahead_.end()) return;
  const double seconds = ahead->seconds_until_needed;
  const CellId finest = ahead->finest;
  ahead_.erase(ahead);
  if (plan) {
    pump_->prefetch(std::move(*plan), seconds);
  } else if (plan.error().code == ErrorCode::kNotFound) {
    ++metrics_.leaves_blocked_ahead;
    blocked_.push_back(finest);
    if (blocked_.size() > kBlockedKept) blocked_.pop_front();
    ask_ahead();  // its place is free for a leaf beyond
  }
}

void LeafTracker::receive_demanded(std::uint64_t number, LeafAnswer plan) {
  const bool is_newest = demanded_.back().number == number;
  if (!plan) {
    std::erase_if(demanded_, [&](const Question& question) { return question.number == number; });
    if (is_newest && plan.error().code != ErrorCode::kCancelled) events_.on_failure(plan.error());
    return;
  }
  // Earlier questions are answered by this one: its viewpoint is nearer to where the viewer is.
  std::erase_if(demanded_, [&](const Question& question) { return question.number <= number; });
  const bool is_where_viewer_is = (*plan)->speaks_for(grid_, pose_->position);
  // An answer the viewer has already left still beats none: its shells are mostly those of the leaf the viewer is in.
  if (is_where_viewer_is || is_newest || !is_near_current(pose_->position)) {
    if (is_where_viewer_is) demanded_.clear();
    events_.on_enter(std::move(*plan));
  }
  if (!is_where_viewer_is && !is_stopped_) demand();  // who stopped meanwhile sends no pose that would
}

void LeafTracker::note_way() {
  const std::shared_ptr<const LeafPlan>& current = pump_->current();
  if (!current || (leaf_ && *leaf_ == current->leaf) || !is_in_current(pose_->position)) return;
  // Neighbours only: who jumped, or was not told every leaf on the way, teaches nothing.
  if (leaf_ && grid_.box(*leaf_).intersects(grid_.box(current->leaf))) {
    service_->note_transition(previous_leaf_, *leaf_, current->leaf, pose_->position);
    previous_leaf_ = leaf_;
  } else {
    previous_leaf_.reset();
  }
  leaf_ = current->leaf;
}

void LeafTracker::look_ahead(double time_s) {
  note_way();
  targets_ = planner_.update(*pose_, time_s);
  if (leaf_ && !targets_.empty()) {
    const LikelyWays ways(grid_, previous_leaf_, *leaf_, [this](const auto& previous, const CellId& leaf) { return service_->departures(previous, leaf); });
    targets_ = ways.weighed(std::move(targets_), pose_->position, glm::length(planner_.motion().velocity()));
  }
  const auto is_target_in = [&](const Box& box) {
    return std::any_of(targets_.begin(), targets_.end(), [&](const PrefetchTarget& t) { return box.contains(t.viewpoint); });
  };
  const bool is_new_way = planner_.heading_changed();
  if (is_new_way) {
    std::erase_if(ahead_, [&](const Question& question) { return !is_target_in(grid_.box(question.finest)); });
  }
  pump_->keep_prefetch([&](const CellId& leaf) { return is_target_in(grid_.box(leaf)); }, is_new_way);
  ask_ahead();
}

void LeafTracker::ask_ahead() {
  if (is_stopped_ || !pump_->has_spare_capacity()) return;
  // A copy: what is known already is prefetched at once, and the pump may call again.
  for (const PrefetchTarget& target : std::vector<PrefetchTarget>(targets_)) {
    if (ahead_.size() >= kAhead) break;
    if (!is_in_current(target.viewpoint)) ask_for(target);
  }
}

void LeafTracker::ask_for(const PrefetchTarget& target) {
  if (std::shared_ptr<const LeafPlan> known = pump_->announced_at(target.viewpoint)) {
    pump_->prefetch(std::move(known), target.seconds_until_needed);
    return;
  }
  const CellId finest = grid_.cell_at(target.viewpoint, 0);
  if (std::find(blocked_.begin(), blocked_.end(), finest) != blocked_.end()) return;
  const auto is_same = [&](const Question& question) { return question.finest == finest; };
  if (std::any_of(ahead_.begin(), ahead_.end(), is_same) || std::any_of(demanded_.begin(), demanded_.end(), is_same)) return;
  if (pump_->knows_ahead(target.viewpoint)) return;
  Question question{next_number_++, finest, target.seconds_until_needed, {}};
  question.ticket = ask(target.viewpoint, WorkPriority{target.seconds_until_needed, 0.0f, true}, question.number);
  ahead_.push_back(std::move(question));
}

void LeafTracker::stop() {
  is_stopped_ = true;
  demanded_.clear();
  ahead_.clear();
  fallback_.reset();
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// From poses to leaves: which leaf the viewer is in, and which they will be in. Asks the cell service, keeps the
// tickets, and drops what the viewer's way has made pointless.
//
// A leaf answers for every viewpoint in its box, so poses inside the known leaf cost nothing. While an answer is
// outstanding a viewer who walks on waits for it: planning every leaf on the way takes the time in which one of them
// could be made. One who jumps gets a second question, and answers count in the order of their questions. The oldest is
// never dropped for a newer: somebody who moves faster than plans are made still gets plans.
// Leaves ahead are only asked for while the pump has nothing else to do. A fallback view is asked for beside the leaf, not
// after it: it needs no leaf, and is there long before one.
// Threads: the connection's executor. After stop() no event is called any more.
#pragma once

#include <asio/any_io_executor.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/math/camera.h"
#include "server/access/token_bucket.h"
#include "server/schedule/prefetch_planner.h"
#include "server/session/payload_pump.h"

namespace farfield {

class LeafTracker : public std::enable_shared_from_this<LeafTracker> {
 public:
  struct Events {
    std::function<void(std::shared_ptr<const LeafPlan>)> on_enter;
    std::function<void(const Error&)> on_failure;
    /// Ask move() again after this time: the rate of leaf changes is used up.
    std::function<void(TokenBucket::Clock::duration)> on_wait;
    /// Asked before a leaf that may cost work. Returns: zero if it may, else how long to wait; may be empty.
    std::function<TokenBucket::Clock::duration(TokenBucket::Clock::time_point)> may_view = {};
  };
  LeafTracker(asio::any_io_executor executor, std::shared_ptr<CellService> service, std::shared_ptr<PayloadPump> pump,
              PrefetchPlanner& planner, const ServerLimits& limits, SessionMetrics& metrics, Events events,
              std::shared_ptr<const void> keep_alive);

  /// The newest pose, scene frame; `time_s` on the client's clock. `wants_fallback`: nothing usable is on the screen.
  void move(const Pose& pose, double time_s, bool wants_fallback);
  /// The same viewpoint again, after on_wait.
  void move_again();
  /// The pump has time for what is ahead.
  void ask_ahead();
  void stop();

 private:
  /// One question about a viewpoint, under way.
  struct Question {
    std::uint64_t number = 0;
    CellId finest;              // the finest cell that holds the viewpoint
    double seconds_until_needed = 0;
    Ticket ticket;
  };
  using LeafAnswer = Result<std::shared_ptr<const LeafPlan>>;

  void demand();
  void look_ahead(double time_s);
  void note_way();
  void ask_for(const PrefetchTarget& target);
  void ask_fallback();
  Ticket ask(const glm::dvec3& viewpoint, const WorkPriority& priority, std::uint64_t number);
  void receive(std::uint64_t number, LeafAnswer plan);
  void receive_demanded(std::uint64_t number, LeafAnswer plan);
  bool is_in_current(const glm::dvec3& viewpoint) const;
  /// At most one of its sides outside the current leaf.
  bool is_near_current(const glm::dvec3& viewpoint) const;

  static constexpr std::size_t kDemanded = 2;  // questions about where the viewer is
  static constexpr std::size_t kAhead = 2;     // about where they will be
  /// Nothing can be asked for before the leaf is known: its plan goes before the tiles of the leaf being left.
  static constexpr double kPlanOverdue_s = 2.0;
  static_assert(kPlanOverdue_s < PayloadPump::kFallbackOverdue_s);

  asio::any_io_executor executor_;
  std::shared_ptr<CellService> service_;
  std::shared_ptr<PayloadPump> pump_;
  PrefetchPlanner& planner_;
  SessionMetrics& metrics_;
  Events events_;
  std::shared_ptr<const void> keep_alive_;
  CellGrid grid_;
  TokenBucket leaf_rate_;
  std::optional<Pose> pose_;
  std::uint64_t next_number_ = 1;
  std::vector<Question> demanded_, ahead_;  // oldest first
  std::optional<Question> fallback_;        // under way
  /// Finest cells ahead in which nobody can stand, the last few found: not asked about again with every pose.
  static constexpr std::size_t kBlockedKept = 32;
  std::deque<CellId> blocked_;
  std::optional<CellId> previous_leaf_, leaf_;  // the way so far: the leaf the viewer is in, and the one before
  std::vector<PrefetchTarget> targets_;     // of the newest pose that had any
  bool is_stopped_ = false;
};

}  // namespace farfield

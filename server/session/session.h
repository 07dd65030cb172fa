// SPDX-License-Identifier: Apache-2.0
// One client's session: hello, welcome, then poses in and leaf sets out.
//
//   waiting ── Hello ──▶ running ── Bye, cut, drain, silence ──▶ closed
//      └── wrong version, no such scene, garbage: Failure ──────────┘
//
// Threads: the connection's executor, except drain() and supersede(), which may be called from anywhere.
// Ownership: the connection's events keep the session alive until the connection is closed.
#pragma once

#include <asio/io_context.hpp>
#include <asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/access/client_limits.h"
#include "server/access/token_register.h"
#include "server/session/leaf_tracker.h"
#include "server/session/payload_pump.h"
#include "server/session/resume_registry.h"

namespace farfield {

/// What all sessions of a server share; outlives them.
struct SessionWorld {
  std::vector<std::shared_ptr<CellService>> catalogue;  // not empty, names unique
  ServerLimits limits;
  SessionMetrics& metrics;
  ResumeRegistry& registry;
  std::shared_ptr<TokenRegister> tokens;                // null: everybody may come in
  std::shared_ptr<ClientLimits> token_limits;           // of one token over all its sessions; null where `tokens` is
  std::function<void(const std::string&)> log;          // one line per event; may be empty; thread-safe
};

class Session : public std::enable_shared_from_this<Session> {
 public:
  /// `first_serial`: of a new session's leaf sets; apart from those of all other sessions. `visit`: the address's, may be null.
  Session(std::shared_ptr<asio::io_context> context, std::shared_ptr<Connection> connection, const SessionWorld& world,
          std::uint64_t first_serial, std::shared_ptr<ClientLimits::Visit> visit);

  void start(std::function<void()> on_closed);

  // ── from any thread ──
  /// GoAway, then the end once everything queued is sent or `grace` is over.
  void drain(std::string reason, std::chrono::milliseconds grace);
  /// The client is back on another connection.
  void supersede();

 private:
  using Clock = std::chrono::steady_clock;
  static asio::awaitable<void> watch(std::shared_ptr<Session> self);

  void receive(IncomingFrame frame);
  Status dispatch(const IncomingFrame& frame);
  Status handle_hello(const IncomingFrame& frame);
  /// Who does not come in has been told why, and Hello is not looked at any further.
  bool admit(const std::string& access_token);
  Clock::duration wait_for_view(Clock::time_point now);
  void report_failed_work(const Error& error);
  void send_away(const Refusal& refusal);
  Status handle_pose(const IncomingFrame& frame);
  Status handle_evicted(const IncomingFrame& frame);
  Status handle_ping(const IncomingFrame& frame);
  void take_pose();
  TokenDigest owner() const { return admission_ ? admission_->entry.digest : TokenDigest{}; }
  void start_streaming(const std::optional<ResumeState>& resumed);
  void enter(std::shared_ptr<const LeafPlan> plan);
  void wait_and_move(Clock::duration wait);
  void check_silence();
  void refuse(const Error& error);
  void close(const Error& reason);
  void log(const std::string& what) const;

  std::shared_ptr<asio::io_context> context_;  // first: everything below needs it to its end
  std::shared_ptr<Connection> connection_;
  const SessionWorld& world_;
  const std::uint64_t first_serial_;
  std::function<void()> on_closed_;
  asio::steady_timer watch_timer_, pose_timer_;
  std::shared_ptr<ClientLimits::Visit> address_visit_, token_visit_;
  std::optional<Admission> admission_;  // where tokens are asked for, from Hello on
  Clock::time_point started_ = Clock::now();
  Clock::time_point last_ping_{};
  std::uint64_t pings_ = 0;
  bool is_pose_timer_armed_ = false;
  bool has_reported_ = false;

  // From Hello on.
  std::shared_ptr<CellService> service_;
  std::string program_, token_;
  std::optional<PrefetchPlanner> planner_;
  std::shared_ptr<PayloadPump> pump_;
  std::shared_ptr<LeafTracker> tracker_;
  TokenBucket pose_rate_;
  struct NewestPose {
    Pose pose;
    double time_s = 0;
    std::uint64_t sequence = 0;
    bool wants_fallback = false;
    bool awaits_leaf_set = false;
    bool is_taken = false;
  };
  std::optional<NewestPose> pose_;
};

}  // namespace farfield

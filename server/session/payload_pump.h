// SPDX-License-Identifier: Apache-2.0
// Feeds one client: pulls payloads from the cell service as fast as the connection drains, in the order of the leaf
// sets the viewer needs, and never the same payload twice.
//
//   leaf streams ── next item not held ──▶ request (ticket) ──▶ arrived ──▶ outbox, while it has room
//
// Order: the fallback view, if nothing usable is on the screen; the leaf just left, while finishing it takes at most
// half of what the current leaf takes (a viewer who walks faster than sets are made then sees sets of a moment ago
// instead of none); the current leaf; and, only when all these are done, leaves ahead.
//
// Back-pressure: nothing is requested while the outbox is full, and never more than `limits.requests` at a time, so
// a slow client costs a bounded amount of memory and delays nobody. Stale: entering a leaf withdraws what waits in the
// outbox and the requests that neither the new leaf nor a stream that is kept has a use for.
// Threads: the connection's executor. Answers of the service are posted there.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "common/net/connection.h"
#include "server/schedule/prefetch_planner.h"
#include "server/session/leaf_stream.h"
#include "server/session/server_limits.h"
#include "server/session/session_metrics.h"

namespace farfield {

class PayloadPump : public std::enable_shared_from_this<PayloadPump> {
 public:
  /// What the pump works with; references outlive stop(). `keep_alive` is held as long as answers may still come.
  struct Parts {
    std::shared_ptr<Connection> connection;
    std::shared_ptr<CellService> service;
    const ServerLimits& limits;
    SessionMetrics& metrics;
    PrefetchPlanner& planner;             // its byte budget is kept up to date here
    std::shared_ptr<const void> keep_alive;
  };
  PayloadPump(Parts parts, std::uint64_t first_serial);

  /// How much a fallback view goes before everything else that somebody waits for: it is little work, and shown at once.
  static constexpr double kFallbackOverdue_s = 4.0;

  /// Called whenever has_spare_capacity() has become true.
  void on_spare_capacity(std::function<void()> call) { on_spare_ = std::move(call); }

  // ── what the viewer does ──
  /// The viewer is in this leaf now. The manifest is sent unless it is one of the last announced on this connection.
  void enter(std::shared_ptr<const LeafPlan> plan);
  /// Nothing usable is on the screen: this fallback view goes first. One at a time: one under way that is more than half
  /// done is finished before.
  void show_fallback(std::shared_ptr<const LeafPlan> fallback);
  /// A leaf the viewer will probably enter. Ignored when it is known already or enough are under way.
  void prefetch(std::shared_ptr<const LeafPlan> plan, double seconds_until_needed);
  /// Drops prefetched leaves for which `is_ahead` is false: those that were sent, or with `is_new_way` all.
  void keep_prefetch(const std::function<bool(const CellId&)>& is_ahead, bool is_new_way);
  /// Whether the client still waits for its leaf set, as far as it has told: then nothing is sent ahead of need.
  void note_awaiting(bool is_awaiting);
  void note_held(ContentHash key) { held_.insert(key); }
  void note_evicted(const std::vector<ContentHash>& keys);

  // ── what drives it ──
  void pump();
  /// Asks again for what the service could not make.
  void retry_failed();
  void stop();

  // ── questions ──
  const std::shared_ptr<const LeafPlan>& current() const { return current_; }
  bool is_current_complete() const;
  /// The current leaf is complete and nothing anybody waits for is under way: time for what is ahead.
  bool has_spare_capacity() const;
  std::uint64_t next_serial() const { return next_serial_; }
  /// A plan this client was told about lately that speaks for the viewpoint, or null.
  std::shared_ptr<const LeafPlan> announced_at(const glm::dvec3& viewpoint) const;
  /// The fallback view sent last, or null.
  const LeafPlan* fallback() const;
  /// The viewpoint's leaf is being sent ahead already, or there is no place for another.
  bool knows_ahead(const glm::dvec3& viewpoint) const;
  std::size_t pending_requests() const { return pending_.size(); }

 private:
  struct Announced {
    std::uint64_t serial = 0;
    std::shared_ptr<const LeafPlan> plan;
    bool is_complete = false;
  };
  struct Pending {
    std::uint64_t request = 0;            // an answer to an earlier request for the same key is ignored
    PayloadItem item;
    std::uint64_t stream = 0;             // serial of the leaf set that wanted it
    bool is_prefetch = false;
    Ticket ticket;
    SharedBytes bytes;                    // once arrived
  };
  /// Clients keep at least this many manifests (proto/README.md).
  static constexpr std::size_t kManifestsKept = 8;

  LeafStream* find_stream(std::uint64_t serial);
  const LeafStream* find_stream(LeafStream::Role role) const;
  Announced* find_announced(const LeafPlan& plan);
  void announce(LeafStream& stream);
  void withdraw_queued(Lane lane);
  /// Cancels the requests for which `is_stale` holds.
  void drop_requests(const std::function<bool(ContentHash, const Pending&)>& is_stale);
  void drop_stream(std::size_t index);
  void leave_current(const LeafStream& next);
  std::size_t missing(const LeafStream& stream) const { return stream.items().size() - stream.count_held(held_); }
  void request(const PayloadItem& item, LeafStream& stream);
  Ticket ask(const PayloadItem& item, const LeafStream& stream, std::uint64_t request);
  void receive(ContentHash key, std::uint64_t request, Result<SharedBytes> bytes);
  void send_arrived();
  void finish_streams();
  void request_more();
  bool send(Pending& pending);

  Parts parts_;
  HeldSet held_;
  std::uint64_t next_serial_;
  std::uint64_t next_request_ = 1;
  std::shared_ptr<const LeafPlan> current_;
  std::vector<std::unique_ptr<LeafStream>> streams_;  // in order of urgency: of LeafStream::Role, then of need
  std::deque<Announced> announced_;                    // newest last, fallback views left out
  std::unordered_map<ContentHash, Pending> pending_;
  std::deque<ContentHash> arrived_;                    // keys of pending payloads that can be sent
  std::unordered_set<ContentHash> failed_;
  std::size_t pending_prefetch_ = 0;
  std::function<void()> on_spare_;
  bool is_awaited_ = false;
  bool was_spare_ = false;
  bool is_stopped_ = false;
  bool is_pumping_ = false;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// One leaf set on its way to one client: what it consists of, and how far it has come. No I/O.
#pragma once

#include <memory>
#include <span>
#include <unordered_set>
#include <vector>

#include "server/session/held_set.h"
#include "server/session/payload_order.h"

namespace farfield {

class LeafStream {
 public:
  /// kLeft: of a leaf the viewer has just left, nearer to complete than the current one.
  enum class Role { kFallback, kLeft, kCurrent, kPrefetch };

  LeafStream(const CellService& service, std::uint64_t serial, std::shared_ptr<const LeafPlan> plan, Role role,
             double seconds_until_needed)
      : serial(serial),
        plan(std::move(plan)),
        role(role),
        seconds_until_needed(seconds_until_needed),
        items_(payload_order(service, *this->plan)) {}

  const std::uint64_t serial;
  const std::shared_ptr<const LeafPlan> plan;
  Role role;
  const double seconds_until_needed;
  bool is_announced = false;
  bool is_complete = false;          // LeafSetComplete is on its way
  std::size_t prefetched_bytes = 0;

  bool is_fallback() const { return role == Role::kFallback; }
  bool is_prefetch() const { return role == Role::kPrefetch; }
  std::span<const PayloadItem> items() const { return items_; }

  /// The next item neither held nor skipped by `is_waiting`, or null; looks at each item once until rewind().
  template <class IsWaiting>
  const PayloadItem* next_item(const HeldSet& held, IsWaiting is_waiting) {
    for (; next_ < items_.size(); ++next_) {
      const PayloadItem& item = items_[next_];
      if (!held.contains(item.key) && !is_done_without(item.key) && !is_waiting(item.key)) return &items_[next_++];
    }
    return nullptr;
  }
  /// Look at every item again: something was withdrawn, lost, or failed.
  void rewind() { next_ = done_ = 0; }
  /// Every item is held by the client (or it does without).
  bool is_all_sent(const HeldSet& held) {
    while (done_ < items_.size() && (held.contains(items_[done_].key) || is_done_without(items_[done_].key))) ++done_;
    return done_ == items_.size();
  }
  std::size_t count_held(const HeldSet& held) const {
    std::size_t count = 0;
    for (const PayloadItem& item : items_) count += held.contains(item.key) ? 1 : 0;
    return count;
  }
  /// What a manifest does not cause to be sent.
  struct HeldCount {
    std::size_t payloads = 0, tiles = 0, bytes = 0;
  };
  HeldCount held_already(const HeldSet& held) const {
    HeldCount count;
    for (const PayloadItem& item : items_) {
      if (!held.contains(item.key)) continue;
      ++count.payloads;
      count.tiles += item.kind == PayloadItem::Kind::kTile;
      count.bytes += held.bytes(item.key);
    }
    return count;
  }

  /// The client no longer holds these. Each item is sent again once: whoever evicts it a second time has no room for
  /// it. Returns: whether any belongs to this stream.
  bool lose(const std::unordered_set<ContentHash>& keys) {
    bool lost_any = false;
    for (const PayloadItem& item : items_) {
      if (!keys.contains(item.key)) continue;
      lost_any = true;
      if (!lost_once_.insert(item.key).second) lost_twice_.insert(item.key);
    }
    if (lost_any) rewind();
    return lost_any;
  }

 private:
  bool is_done_without(ContentHash key) const { return !lost_twice_.empty() && lost_twice_.contains(key); }

  std::vector<PayloadItem> items_;
  std::size_t next_ = 0, done_ = 0;
  std::unordered_set<ContentHash> lost_once_, lost_twice_;
};

}  // namespace farfield

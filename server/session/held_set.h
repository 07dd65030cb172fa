// SPDX-License-Identifier: Apache-2.0
// Which payloads a client holds, by key: what never needs to be sent again. Bounded: beyond the bound the oldest keys
// are forgotten, whose payloads would then be sent again. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>

#include "common/base/hash.h"

namespace farfield {

class HeldSet {
 public:
  explicit HeldSet(std::size_t capacity) : capacity_(capacity) {}

  bool contains(ContentHash key) const { return held_.contains(key); }
  /// `bytes`: of the payload as sent, where that is known.
  void insert(ContentHash key, std::size_t bytes = 0) {
    if (!held_.try_emplace(key, Held{next_, bytes}).second) return;
    order_.emplace_back(next_++, key);
    while (held_.size() > capacity_) forget_oldest();
  }
  /// Of a payload held; 0 if it is not, or its size is not known.
  std::size_t bytes(ContentHash key) const {
    const auto found = held_.find(key);
    return found == held_.end() ? 0 : found->second.bytes;
  }
  /// Returns: whether it was there.
  bool erase(ContentHash key) {
    // Its place in order_ stays behind, recognised as stale by its serial; they are swept once they outnumber the rest.
    if (held_.erase(key) == 0) return false;
    if (order_.size() > 2 * held_.size() + 64) sweep();
    return true;
  }
  std::size_t size() const { return held_.size(); }

 private:
  struct Held {
    std::uint64_t serial = 0;
    std::size_t bytes = 0;
  };
  using Place = std::pair<std::uint64_t, ContentHash>;
  bool is_live(const Place& place) const {
    const auto found = held_.find(place.second);
    return found != held_.end() && found->second.serial == place.first;
  }
  void forget_oldest() {
    while (!is_live(order_.front())) order_.pop_front();
    held_.erase(order_.front().second);
    order_.pop_front();
  }
  void sweep() {
    std::erase_if(order_, [this](const Place& place) { return !is_live(place); });
  }

  std::size_t capacity_;
  std::uint64_t next_ = 0;
  std::unordered_map<ContentHash, Held> held_;
  std::deque<Place> order_;  // oldest first
};

}  // namespace farfield

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

  bool contains(ContentHash key) const { return serials_.contains(key); }
  void insert(ContentHash key) {
    if (!serials_.try_emplace(key, next_).second) return;
    order_.emplace_back(next_++, key);
    while (serials_.size() > capacity_) forget_oldest();
  }
  /// Returns: whether it was there.
  bool erase(ContentHash key) {
    // Its place in order_ stays behind, recognised as stale by its serial; they are swept once they outnumber the rest.
    if (serials_.erase(key) == 0) return false;
    if (order_.size() > 2 * serials_.size() + 64) sweep();
    return true;
  }
  std::size_t size() const { return serials_.size(); }

 private:
  using Place = std::pair<std::uint64_t, ContentHash>;
  bool is_live(const Place& place) const {
    const auto found = serials_.find(place.second);
    return found != serials_.end() && found->second == place.first;
  }
  void forget_oldest() {
    while (!is_live(order_.front())) order_.pop_front();
    serials_.erase(order_.front().second);
    order_.pop_front();
  }
  void sweep() {
    std::erase_if(order_, [this](const Place& place) { return !is_live(place); });
  }

  std::size_t capacity_;
  std::uint64_t next_ = 0;
  std::unordered_map<ContentHash, std::uint64_t> serials_;
  std::deque<Place> order_;  // oldest first
};

}  // namespace farfield

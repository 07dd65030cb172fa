// SPDX-License-Identifier: Apache-2.0
// Divides a fixed number of units (vertices, indices, layers) among tenants that come and go. First fit, neighbouring
// free ranges merge. O(free ranges) per call. CPU only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace farfield::client {

class RangeAllocator {
 public:
  explicit RangeAllocator(std::uint32_t capacity) : free_units_(capacity) {
    if (capacity > 0) free_.emplace(0, capacity);
  }

  /// Returns: the first unit of `count` adjacent ones, or nothing where no gap is that long. count 0 always fits.
  std::optional<std::uint32_t> allocate(std::uint32_t count) {
    if (count == 0) return 0;
    for (auto gap = free_.begin(); gap != free_.end(); ++gap) {
      const auto [first, length] = *gap;
      if (length < count) continue;
      free_.erase(gap);
      if (length > count) free_.emplace(first + count, length - count);
      free_units_ -= count;
      return first;
    }
    return std::nullopt;
  }

  /// Requires: allocate(count) returned `first`, and it was not released since.
  void release(std::uint32_t first, std::uint32_t count) {
    if (count == 0) return;
    free_units_ += count;
    auto next = free_.lower_bound(first);
    if (next != free_.end() && first + count == next->first) {
      count += next->second;
      next = free_.erase(next);
    }
    if (next != free_.begin()) {
      const auto previous = std::prev(next);
      if (previous->first + previous->second == first) {
        previous->second += count;
        return;
      }
    }
    free_.emplace(first, count);
  }

  std::uint32_t free_units() const { return free_units_; }

 private:
  std::map<std::uint32_t, std::uint32_t> free_;  // first unit → length
  std::uint32_t free_units_;
};

}  // namespace farfield::client

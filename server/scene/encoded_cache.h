// SPDX-License-Identifier: Apache-2.0
// Encoded chunks and texture levels, kept while they are asked for: a least-recently-used cache bounded in bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <unordered_map>

#include "common/base/bytes.h"

namespace farfield {

/// Safe from any thread.
class EncodedCache {
 public:
  explicit EncodedCache(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// The bytes stored under `key`, else what `encode()` returns, which is then stored. Two threads that ask for the
  /// same key at once may both encode; the first result stays.
  template <class Encode>
  SharedBytes get(std::uint64_t key, Encode encode) {
    if (SharedBytes found = find(key)) return found;
    return insert(key, std::make_shared<const Bytes>(encode()));
  }
  std::size_t size_bytes() const {
    const std::lock_guard lock(mutex_);
    return size_bytes_;
  }

 private:
  struct Entry {
    std::uint64_t key;
    SharedBytes bytes;
  };

  SharedBytes find(std::uint64_t key) {
    const std::lock_guard lock(mutex_);
    const auto found = index_.find(key);
    if (found == index_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->bytes;
  }
  SharedBytes insert(std::uint64_t key, SharedBytes bytes) {
    const std::lock_guard lock(mutex_);
    if (const auto found = index_.find(key); found != index_.end()) return found->second->bytes;
    if (bytes->size() > budget_bytes_) return bytes;
    entries_.push_front({key, bytes});
    index_[key] = entries_.begin();
    size_bytes_ += bytes->size();
    while (size_bytes_ > budget_bytes_) {
      size_bytes_ -= entries_.back().bytes->size();
      index_.erase(entries_.back().key);
      entries_.pop_back();
    }
    return bytes;
  }

  const std::size_t budget_bytes_;
  mutable std::mutex mutex_;  // guards everything below
  std::size_t size_bytes_ = 0;
  std::list<Entry> entries_;  // most recently used first
  std::unordered_map<std::uint64_t, std::list<Entry>::iterator> index_;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// A map bounded in bytes that forgets what was used longest ago. The caller says how many bytes each value holds;
// the map adds what its own nodes cost, so the bound is on memory, not on payload.
//
// Invariants: bytes() <= capacity_bytes() after every call; the list and the index hold the same keys.
// Not thread-safe: owners put their mutex around it. Every call is O(1), insert amortised over what it evicts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <unordered_map>
#include <utility>

namespace farfield {

template <class Key, class Value, class Hash = std::hash<Key>>
class ByteBoundedLru {
  struct Entry {
    Key key;
    Value value;
    std::size_t bytes;  // with overhead
  };
  using Order = std::list<Entry>;  // front: used last

 public:
  /// What one entry costs beyond its value's own bytes: a list node (two links), an index node (link, cached hash,
  /// key, iterator), its share of the bucket array, and the allocator's header of each of the two nodes.
  static constexpr std::size_t kEntryOverheadBytes = sizeof(Entry) + 2 * sizeof(void*)                  //
                                                     + sizeof(Key) + 3 * sizeof(void*) + sizeof(void*)  //
                                                     + 2 * 2 * sizeof(void*);

  explicit ByteBoundedLru(std::size_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  /// Returns: the value, now the most recently used, or null. The pointer lives until the next insert or erase.
  const Value* find(const Key& key) {
    const auto at = index_.find(key);
    if (at == index_.end()) return nullptr;
    order_.splice(order_.begin(), order_, at->second);
    return &at->second->value;
  }
  /// The same without counting as a use.
  const Value* peek(const Key& key) const {
    const auto at = index_.find(key);
    return at == index_.end() ? nullptr : &at->second->value;
  }

  /// Keeps `value` as the most recently used, in place of an earlier one of the same key, and forgets the least
  /// recently used until everything fits. Returns: false if it alone is larger than the bound; then nothing is kept
  /// under this key and nothing else is evicted for it.
  bool insert(const Key& key, Value value, std::size_t value_bytes) {
    erase(key);
    if (value_bytes > capacity_bytes_ || capacity_bytes_ - value_bytes < kEntryOverheadBytes) return false;
    const std::size_t bytes = value_bytes + kEntryOverheadBytes;
    while (capacity_bytes_ - bytes_ < bytes) {
      ++evictions_;
      forget(std::prev(order_.end()));
    }
    order_.push_front({key, std::move(value), bytes});
    index_.emplace(key, order_.begin());
    bytes_ += bytes;
    return true;
  }

  bool erase(const Key& key) {
    const auto at = index_.find(key);
    if (at == index_.end()) return false;
    forget(at->second);
    return true;
  }

  std::size_t bytes() const { return bytes_; }
  std::size_t size() const { return index_.size(); }
  std::size_t capacity_bytes() const { return capacity_bytes_; }
  std::uint64_t evictions() const { return evictions_; }

 private:
  void forget(typename Order::iterator entry) {
    bytes_ -= entry->bytes;
    index_.erase(entry->key);
    order_.erase(entry);
  }

  Order order_;
  std::unordered_map<Key, typename Order::iterator, Hash> index_;
  std::size_t bytes_ = 0;
  std::size_t capacity_bytes_;
  std::uint64_t evictions_ = 0;
};

}  // namespace farfield

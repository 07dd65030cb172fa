// SPDX-License-Identifier: Apache-2.0
// Something made once for each cell, by whoever asks first.
#pragma once

#include <memory>
#include <mutex>
#include <unordered_map>

#include "common/base/result.h"
#include "common/cells/cell_id.h"

namespace farfield {

/// Thread-safe. Bounded: forgets everything beyond `most` cells. What is made must depend on the cell only, so that what is
/// made again is the same.
template <class Value>
class PerCell {
 public:
  explicit PerCell(std::size_t most) : most_(most) {}

  /// `make()` returns Result<std::shared_ptr<const Value>>; callers that meet wait for each other, and errors are not remembered.
  template <class Make>
  Result<std::shared_ptr<const Value>> get(const CellId& cell, Make make) {
    const std::shared_ptr<Entry> entry = entry_of(cell);
    const std::lock_guard lock(entry->mutex);
    if (entry->value) return entry->value;
    Result<std::shared_ptr<const Value>> made = make();
    if (made) entry->value = *made;
    return made;
  }

 private:
  struct Entry {
    std::mutex mutex;
    std::shared_ptr<const Value> value;
  };
  std::shared_ptr<Entry> entry_of(const CellId& cell) {
    const std::lock_guard lock(mutex_);
    if (entries_.size() >= most_ && !entries_.contains(cell)) entries_.clear();
    std::shared_ptr<Entry>& slot = entries_[cell];
    if (!slot) slot = std::make_shared<Entry>();
    return slot;
  }

  const std::size_t most_;
  std::mutex mutex_;  // guards entries_, not what they point to
  std::unordered_map<CellId, std::shared_ptr<Entry>> entries_;
};

}  // namespace farfield

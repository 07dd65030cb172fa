// SPDX-License-Identifier: Apache-2.0
// Decoded payloads on their way from the decode pool to the network thread. Thread-safe.
#pragma once

#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "client/decode/payload.h"
#include "common/base/result.h"

namespace farfield::client {

class DecodeInbox {
 public:
  struct Item {
    PayloadName name;
    Result<DecodedPayload> result;
  };

  /// Returns: whether the inbox was empty, so that the receiver has to be told.
  bool put(Item item) {
    const std::lock_guard lock(mutex_);
    items_.push_back(std::move(item));
    filled_.notify_one();
    return items_.size() == 1;
  }
  std::vector<Item> take_all() {
    const std::lock_guard lock(mutex_);
    return std::exchange(items_, {});
  }
  /// Blocks until there is something. Requires: something is being decoded.
  std::vector<Item> wait_and_take_all() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [this] { return !items_.empty(); });
    return std::exchange(items_, {});
  }

 private:
  std::mutex mutex_;  // guards items_
  std::condition_variable filled_;
  std::vector<Item> items_;
};

}  // namespace farfield::client

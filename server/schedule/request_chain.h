// SPDX-License-Identifier: Apache-2.0
// A request that waits several times, one wait after the other: for the disk, for a leaf's name, for its plan, for another server.
// Releasing it withdraws from whichever wait it has come to.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "server/schedule/cell_service.h"

namespace farfield {

/// Thread-safe.
class RequestChain : public std::enable_shared_from_this<RequestChain> {
 public:
  /// Begins the next wait: `join` returns what withdraws from it. Waits may end, and later ones begin, before `join` returns.
  template <class Join>
  void wait(Join join) {
    int step = 0;
    {
      const std::scoped_lock lock(mutex_);
      if (is_released_) return;
      step = ++begun_;
    }
    std::function<void()> withdraw = join();
    {
      const std::scoped_lock lock(mutex_);
      if (!is_released_) {
        if (step > step_) step_ = step, withdraw_.swap(withdraw);
        return;
      }
    }
    withdraw();  // released meanwhile
  }
  Ticket ticket() {
    return Ticket([self = shared_from_this()] { self->release(); });
  }

 private:
  void release() {
    std::unique_lock lock(mutex_);
    is_released_ = true;
    const auto withdraw = std::exchange(withdraw_, nullptr);
    lock.unlock();
    if (withdraw) withdraw();
  }

  std::mutex mutex_;  // guards everything below; never held while others are called
  bool is_released_ = false;
  int begun_ = 0, step_ = 0;  // waits; the one that withdraw_ is of
  std::function<void()> withdraw_;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Waiting for what another server makes: a thread that asks for all the leases waited for at once, 40 times a second while there are any.
// No casting thread waits, and no prompt one.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/store/generation_lease.h"

namespace farfield {

/// Thread-safe.
class LeaseWaits {
 public:
  using Clock = std::chrono::steady_clock;
  using GoOn = std::function<void()>;
  struct Wait {
    BlobKey key;
    Clock::time_point until;
    GoOn go_on;
    std::atomic<bool> is_claimed{false};  // by its end or by its withdrawal
  };
  using Handle = std::shared_ptr<Wait>;

  explicit LeaseWaits(std::shared_ptr<GenerationLease> lease);
  ~LeaseWaits() { stop(); }
  LeaseWaits(const LeaseWaits&) = delete;
  LeaseWaits& operator=(const LeaseWaits&) = delete;

  /// Calls `go_on` once, on the thread of the waits, when nobody holds `key` any more or `until` has come; not before the next time
  /// the leases are looked at. Never after stop().
  Handle wait(const BlobKey& key, Clock::time_point until, GoOn go_on);
  /// `go_on` is not called from now on, unless it has begun.
  void withdraw(const Handle& wait);
  /// Forgets all waits, and those that still come, and returns when no `go_on` runs.
  void stop();
  std::size_t size() const;

 private:
  static constexpr std::chrono::milliseconds kPeriod{25};
  static constexpr std::size_t kMostAtOnce = 512;  // leases asked for in one command

  void look(const std::stop_token& stop);

  const std::shared_ptr<GenerationLease> lease_;
  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable_any changed_;
  std::vector<Handle> waits_;
  bool is_stopped_ = false;
  std::jthread thread_;
};

}  // namespace farfield

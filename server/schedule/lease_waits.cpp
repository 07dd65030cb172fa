// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/lease_waits.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

namespace farfield {

LeaseWaits::LeaseWaits(std::shared_ptr<GenerationLease> lease) : lease_(std::move(lease)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { look(stop); });
  pthread_setname_np(thread_.native_handle(), "lease-wait");
}

LeaseWaits::Handle LeaseWaits::wait(const BlobKey& key, Clock::time_point until, GoOn go_on) {
  auto wait = std::make_shared<Wait>();
  wait->key = key, wait->until = until, wait->go_on = std::move(go_on);
  const std::scoped_lock lock(mutex_);
  if (is_stopped_) return wait;
  waits_.push_back(wait);
  changed_.notify_all();
  return wait;
}

void LeaseWaits::withdraw(const Handle& wait) {
  if (wait->is_claimed.exchange(true)) return;
  const GoOn dropped = std::move(wait->go_on);  // and what it holds, after the lock is given back
  const std::scoped_lock lock(mutex_);
  std::erase(waits_, wait);
}

void LeaseWaits::stop() {
  std::vector<Handle> dropped;
  {
    const std::scoped_lock lock(mutex_);
    is_stopped_ = true;
    dropped.swap(waits_);
  }
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

std::size_t LeaseWaits::size() const {
  const std::scoped_lock lock(mutex_);
  return waits_.size();
}

void LeaseWaits::look(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    changed_.wait(lock, stop, [this] { return !waits_.empty(); });
    changed_.wait_for(lock, stop, kPeriod, [] { return false; });
    if (stop.stop_requested()) return;
    std::vector<BlobKey> keys;
    for (const Handle& wait : waits_) keys.push_back(wait->key);
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    lock.unlock();
    std::vector<BlobKey> held;  // sorted
    for (std::size_t at = 0; at < keys.size(); at += kMostAtOnce) {
      const std::span<const BlobKey> some = std::span(keys).subspan(at, std::min(kMostAtOnce, keys.size() - at));
      const std::vector<bool> are_held = lease_->are_held(some);
      for (std::size_t i = 0; i < some.size(); ++i)
        if (are_held[i]) held.push_back(some[i]);
    }
    const Clock::time_point now = Clock::now();
    std::vector<Handle> over;
    lock.lock();
    std::erase_if(waits_, [&](const Handle& wait) {
      // Begun since: looked at the next time.
      const bool is_known = std::binary_search(keys.begin(), keys.end(), wait->key);
      const bool is_over = now >= wait->until || (is_known && !std::binary_search(held.begin(), held.end(), wait->key));
      if (is_over) over.push_back(wait);
      return is_over;
    });
    lock.unlock();
    for (const Handle& wait : over) {
      if (stop.stop_requested()) break;
      if (!wait->is_claimed.exchange(true)) std::exchange(wait->go_on, nullptr)();
    }
    over.clear();
    lock.lock();
  }
}

}  // namespace farfield

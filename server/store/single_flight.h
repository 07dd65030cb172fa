// SPDX-License-Identifier: Apache-2.0
// Single flight: however many ask for one key, it is made once at a time, and everyone gets that one result.
//
// Life of a flight:        join                      worker takes the job           make returns
//          (none) ───────────────────▶ queued ───────────────────────▶ running ───────────────────▶ (none)
//                                        │ last waiter withdraws         │ last waiter withdraws
//                                        ▼                               ▼
//                                    (none), job removed             running, cancel flag set
//                                                                        │ make returns
//                                                    nobody joined since ▼ ▼ somebody joined since, no value made
//                                                                  (none)   queued again, with a new flag
// A set flag is never cleared: work that saw it may already have cut corners.
//
// Invariants: 1. at most one call of `make` per key runs at a time. 2. A queued flight has a waiter. 3. Every answer
// is called at most once, on the thread that finished the work, without any lock held, and never after withdraw()
// returned unless it had begun. 4. A failed or throwing make fails its waiters with one error and leaves nothing
// behind: the next join tries again.
//
// Queue is where work runs:
//   using Priority = …;                                   // with is_before(other): more urgent than
//   JobId push(const Priority&, std::function<void()>);   // 0: refused
//   void raise(JobId, const Priority&);                   // the more urgent of both counts
//   bool remove(JobId);                                   // true: it had not begun and never will
// It never calls back from inside these functions. Thread-safe.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "server/cells/leaf_plan.h"

namespace farfield {

struct FlightStatistics {
  std::uint64_t begun = 0;      // calls of make
  std::uint64_t shared = 0;     // requests that joined work already under way
  std::uint64_t failed = 0;     // of begun: ended in an error nobody asked for
  std::uint64_t cancelled = 0;  // flights given up, queued or running, because nobody wanted them any more
  std::uint64_t refused = 0;    // requests the queue had no room for
};

template <class Key, class Value, class Queue, class Hash = std::hash<Key>>
class SingleFlight {
 public:
  using Priority = typename Queue::Priority;
  using Make = std::function<Result<Value>(const CancelFlag&)>;
  using Answer = std::function<void(Result<Value>)>;
  /// A waiter's own handle; opaque.
  struct Waiter {
    Answer answer;
    std::atomic<bool> is_claimed{false};  // by the answer or by the withdrawal, whichever comes first
  };
  using Handle = std::shared_ptr<Waiter>;

  /// `queue` outlives this.
  explicit SingleFlight(Queue& queue) : queue_(queue) {}
  /// Forgets all waiters without answering them, cancels everything and waits for the makes and answers that run.
  /// Requires: nobody joins any more, and somebody still runs the jobs taken from the queue. Not from within an answer.
  ~SingleFlight() {
    std::unique_lock lock(mutex_);
    for (auto at = flights_.begin(); at != flights_.end();) {
      Flight& flight = at->second;
      for (const Handle& waiter : flight.waiters) waiter->is_claimed = true;
      flight.waiters.clear();
      if (flight.cancel) flight.cancel->store(true);
      at = !flight.cancel && queue_.remove(flight.job) ? flights_.erase(at) : std::next(at);
    }
    finished_.wait(lock, [this] { return flights_.empty() && answering_ == 0; });
  }
  SingleFlight(const SingleFlight&) = delete;
  SingleFlight& operator=(const SingleFlight&) = delete;

  /// Waits for `key`; `make` is called on the queue's worker if nobody makes it yet.
  /// Returns: the handle to withdraw with; null if the queue refused, then `answer` was called with kUnavailable.
  Handle join(const Key& key, const Priority& priority, Make make, Answer answer) {
    auto waiter = std::make_shared<Waiter>();
    waiter->answer = std::move(answer);
    {
      const std::scoped_lock lock(mutex_);
      const auto [at, is_new] = flights_.try_emplace(key);
      Flight& flight = at->second;
      if (!is_new) {
        ++statistics_.shared;
        flight.priority = flight.waiters.empty() || priority.is_before(flight.priority) ? priority : flight.priority;
        flight.waiters.push_back(waiter);
        if (!flight.cancel) queue_.raise(flight.job, priority);
        return waiter;
      }
      flight.make = std::make_shared<const Make>(std::move(make));
      flight.priority = priority;
      if (enqueue(key, flight)) {
        flight.waiters.push_back(waiter);
        return waiter;
      }
      flights_.erase(at);
      ++statistics_.refused;
    }
    waiter->answer(overloaded());
    return nullptr;
  }

  /// The waiter of `handle` is no longer interested; the last one to go cancels the work. Idempotent.
  void withdraw(const Key& key, const Handle& handle) {
    if (!handle || handle->is_claimed.exchange(true)) return;
    const std::scoped_lock lock(mutex_);
    const auto at = flights_.find(key);
    if (at == flights_.end()) return;
    Flight& flight = at->second;
    if (std::erase(flight.waiters, handle) == 0 || !flight.waiters.empty()) return;
    if (flight.cancel) {
      if (!flight.cancel->exchange(true)) ++statistics_.cancelled;
    } else {
      ++statistics_.cancelled;
      // Not removed: a worker holds the job already and will find nobody waiting.
      if (queue_.remove(flight.job)) flights_.erase(at);
    }
  }

  FlightStatistics statistics() const {
    const std::scoped_lock lock(mutex_);
    return statistics_;
  }
  /// Keys queued or being made.
  std::size_t size() const {
    const std::scoped_lock lock(mutex_);
    return flights_.size();
  }

 private:
  struct Flight {
    std::shared_ptr<const Make> make;
    Priority priority;
    std::uint64_t job = 0;
    std::shared_ptr<std::atomic<bool>> cancel;  // null while queued
    std::vector<Handle> waiters;
  };

  static tl::unexpected<Error> overloaded() {
    return fail(ErrorCode::kUnavailable, "the queue of work is full: try again later");
  }

  // Requires: mutex_ held.
  bool enqueue(const Key& key, Flight& flight) {
    flight.cancel = nullptr;
    flight.job = queue_.push(flight.priority, [this, key] { run(key); });
    return flight.job != 0;
  }

  void run(const Key& key) {
    std::shared_ptr<const Make> make;
    std::shared_ptr<std::atomic<bool>> cancel;
    {
      const std::scoped_lock lock(mutex_);
      const auto at = flights_.find(key);
      if (at == flights_.end()) return;
      if (at->second.waiters.empty()) {
        flights_.erase(at);
        finished_.notify_all();
        return;
      }
      ++statistics_.begun;
      at->second.cancel = cancel = std::make_shared<std::atomic<bool>>(false);
      make = at->second.make;
    }
    finish(key, call(*make, cancel));
  }

  // The job edge: what libraries throw becomes an error here.
  static Result<Value> call(const Make& make, const CancelFlag& cancel) {
    try {
      return make(cancel);
    } catch (const std::exception& e) {
      return fail(ErrorCode::kInternal, "generation failed: {}", e.what());
    } catch (...) {
      return fail(ErrorCode::kInternal, "generation failed with an exception of unknown type");
    }
  }

  void finish(const Key& key, Result<Value> result) {
    std::vector<Handle> waiters;
    {
      const std::scoped_lock lock(mutex_);
      const auto at = flights_.find(key);
      if (at == flights_.end()) return;
      Flight& flight = at->second;
      const bool was_cancelled = flight.cancel->load();
      if (!result && !was_cancelled) ++statistics_.failed;
      if (!result && was_cancelled && !flight.waiters.empty()) {
        if (enqueue(key, flight)) return;  // who joined after the cancellation deserves a try of his own
        result = overloaded();
        statistics_.refused += flight.waiters.size();
      }
      waiters = std::move(flight.waiters);
      flights_.erase(at);
      ++answering_;
    }
    for (const Handle& waiter : waiters) {
      if (!waiter->is_claimed.exchange(true)) waiter->answer(result);
    }
    const std::scoped_lock lock(mutex_);
    --answering_;
    finished_.notify_all();
  }

  Queue& queue_;
  mutable std::mutex mutex_;          // guards everything below; taken before the queue's own mutex
  std::condition_variable finished_;  // notified under the mutex: the destructor may go on only after it is released
  int answering_ = 0;                 // threads that are calling answers
  std::unordered_map<Key, Flight, Hash> flights_;
  FlightStatistics statistics_;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// One queue of work over all sessions, most urgent first.
//
// Every job gets a due time when it is pushed: now + seconds until needed, plus kPrefetchDelay_s if nobody waits for
// it yet. Jobs run in the order of due times, rounded down to kDueStep_s; within one step the larger share of the view
// goes first, then what was pushed earlier. Due times are absolute, so waiting work ages by itself: whatever is
// pushed later than a job's due time comes after it, and nothing starves however much demand keeps arriving.
//
// In: closures with a priority. Out: closures, to whoever takes them. Thread-safe; no closure is called or destroyed
// with the lock held. O(log n) per call.
#pragma once

#include <compare>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <unordered_map>

#include "server/schedule/cell_service.h"

namespace farfield {

/// Seconds since some fixed moment, never running backwards. Tests bring their own.
using SecondsClock = std::function<double()>;
SecondsClock steady_clock_seconds();

struct QueueStatistics {
  std::size_t queued = 0;           // now
  std::size_t queued_prefetch = 0;  // of these
  std::uint64_t pushed = 0, taken = 0, removed = 0, refused = 0;
  double oldest_wait_s = 0;   // of the jobs queued now
  double longest_wait_s = 0;  // of all jobs taken so far
};

class JobQueue {
 public:
  using Priority = WorkPriority;
  using JobId = std::uint64_t;
  using Job = std::function<void()>;

  /// Due times closer than this count as equal, so that the share of the view can decide between the tiles of a leaf.
  static constexpr double kDueStep_s = 0.1;
  /// Work that other work waits for may be pushed as overdue by up to this: before all that was asked for since.
  static constexpr double kMostOverdue_s = 2.0;
  /// How far prefetched work stands back behind demanded work due at the same time. Longer than any prediction
  /// reaches: demand that was not foreseen still passes all prefetches, unless they have waited this long already.
  static constexpr double kPrefetchDelay_s = 8.0;

  /// At most `capacity` jobs wait; prefetches are refused from three quarters of it on.
  explicit JobQueue(std::size_t capacity, SecondsClock clock = steady_clock_seconds());

  /// Returns: the job's id, 0 if the queue is full or closed.
  JobId push(const WorkPriority& priority, Job job);
  /// Moves a job forward if `priority` is more urgent than what it was pushed with; never back.
  void raise(JobId id, const WorkPriority& priority);
  /// Returns: true if the job was still queued; it will not run.
  bool remove(JobId id);

  /// The most urgent job, waiting for one if there is none. Returns: an empty function once the queue is closed.
  Job take();
  /// The same without waiting: empty if there is nothing to do.
  Job try_take();
  /// Refuses new jobs and hands out none any more; everyone in take() returns. What is queued can still be removed.
  void close();

  QueueStatistics statistics() const;

 private:
  struct Rank {
    std::int64_t due_step = 0;
    float minus_share = 0;
    JobId id = 0;
    bool operator<(const Rank& other) const;
  };
  struct Waiting {
    Job job;
    double pushed_s = 0;
    bool is_prefetch = false;
  };

  Rank rank(const WorkPriority& priority, JobId id) const;
  Job take_first();

  const SecondsClock clock_;
  const std::size_t capacity_;
  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable pushed_;
  std::map<Rank, Waiting> waiting_;
  std::unordered_map<JobId, Rank> ranks_;
  JobId last_id_ = 0;
  bool is_closed_ = false;
  QueueStatistics statistics_;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Pools of threads that take jobs from one queue until it is closed: "cast" for what processors do, "prompt" for what is done soon. They are
// plain threads; Embree's queries need no more, and a job that uses TBB itself shares the process's one arena.
//
// Casting takes all the processor time there is. Sending what is made takes little, and viewers wait for it: on a machine of its own a
// server's casting threads can be nice to its others. Beside other programs that need the processor they would be made to wait for those.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "server/schedule/job_queue.h"

namespace farfield {

struct PoolStatistics {
  int threads = 0;
  int busy = 0;              // threads inside a job now
  std::uint64_t jobs = 0;    // finished
  std::uint64_t failed = 0;  // of these: let an exception escape
  double busy_seconds = 0;   // sum over the threads, finished jobs only
};

class WorkerPool {
 public:
  /// `queue` outlives the pool. `threads` < 1 counts as 1.
  WorkerPool(JobQueue& queue, int threads, SecondsClock clock = steady_clock_seconds(), const char* name = "cast", int nice = 0);
  /// Closes the queue and waits for the jobs that run.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Begins no further job and waits for those that run, so that what is measured beside the pool has the machine to
  /// itself. Calls nest; each is followed by one of resume().
  void pause();
  void resume();

  PoolStatistics statistics() const;

 private:
  void work();
  void begin_job();
  void end_job();

  JobQueue& queue_;
  const SecondsClock clock_;
  mutable std::mutex mutex_;  // guards the next three
  std::condition_variable changed_;
  int busy_ = 0, pauses_ = 0;
  bool is_closing_ = false;
  std::atomic<std::uint64_t> jobs_{0}, failed_{0}, busy_nanoseconds_{0};
  std::vector<std::jthread> threads_;  // last: its destructor joins while the rest still stands
};

/// A queue and its pool: one of each name per process, shared by the services of all its scenes.
class JobPool {
 public:
  static constexpr std::size_t kDefaultQueueCapacity = 100'000;
  /// `threads` 0: one per processor. `name`: of its threads, with a number behind it.
  /// `nice`: 0 to 19, how much they give way to the process's others (Linux: a thread has a niceness of its own).
  explicit JobPool(int threads = 0, std::size_t queue_capacity = kDefaultQueueCapacity,
                   SecondsClock clock = steady_clock_seconds(), const char* name = "cast", int nice = 0);

  JobQueue& queue() { return queue_; }
  QueueStatistics queue_statistics() const { return queue_.statistics(); }
  PoolStatistics pool_statistics() const { return pool_.statistics(); }
  void pause() { pool_.pause(); }
  void resume() { pool_.resume(); }

 private:
  JobQueue queue_;
  WorkerPool pool_;
};

}  // namespace farfield

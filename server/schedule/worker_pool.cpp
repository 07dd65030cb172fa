// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/worker_pool.h"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace farfield {

WorkerPool::WorkerPool(JobQueue& queue, int threads, SecondsClock clock, const char* name, int nice) : queue_(queue), clock_(std::move(clock)) {
  const int count = std::max(threads, 1);
  threads_.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    threads_.emplace_back([this, nice] {
      // Where it cannot be set nothing but promptness is lost.
      if (nice > 0) (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice);
      work();
    });
    pthread_setname_np(threads_.back().native_handle(), (std::string(name) + "-" + std::to_string(i)).c_str());
  }
}

WorkerPool::~WorkerPool() {
  queue_.close();
  const std::scoped_lock lock(mutex_);
  is_closing_ = true;
  changed_.notify_all();
}

void WorkerPool::pause() {
  std::unique_lock lock(mutex_);
  ++pauses_;
  changed_.wait(lock, [this] { return busy_ == 0; });
}

void WorkerPool::resume() {
  const std::scoped_lock lock(mutex_);
  --pauses_;
  changed_.notify_all();
}

void WorkerPool::begin_job() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return pauses_ == 0 || is_closing_; });
  ++busy_;
}

void WorkerPool::end_job() {
  const std::scoped_lock lock(mutex_);
  --busy_;
  changed_.notify_all();
}

void WorkerPool::work() {
  while (JobQueue::Job job = queue_.take()) {
    begin_job();
    const double begun_s = clock_();
    try {
      job();
    } catch (...) {
      // Jobs report their own failures; one that cannot must not take the other sessions' work down with it.
      ++failed_;
    }
    job = nullptr;  // what the job holds is part of its time
    end_job();
    busy_nanoseconds_ += static_cast<std::uint64_t>(std::llround(std::max(clock_() - begun_s, 0.0) * 1e9));
    ++jobs_;
  }
}

JobPool::JobPool(int threads, std::size_t queue_capacity, SecondsClock clock, const char* name, int nice)
    : queue_(queue_capacity, clock),
      pool_(queue_, threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency()), clock, name, nice) {}

PoolStatistics WorkerPool::statistics() const {
  const std::scoped_lock lock(mutex_);
  return {.threads = static_cast<int>(threads_.size()),
          .busy = busy_,
          .jobs = jobs_.load(),
          .failed = failed_.load(),
          .busy_seconds = static_cast<double>(busy_nanoseconds_.load()) * 1e-9};
}

}  // namespace farfield

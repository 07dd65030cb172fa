// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/worker_pool.h"

#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace farfield {

WorkerPool::WorkerPool(JobQueue& queue, int threads, SecondsClock clock) : queue_(queue), clock_(std::move(clock)) {
  const int count = std::max(threads, 1);
  threads_.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    threads_.emplace_back([this] { work(); });
    pthread_setname_np(threads_.back().native_handle(), ("cast-" + std::to_string(i)).c_str());
  }
}

WorkerPool::~WorkerPool() {
  queue_.close();
}

void WorkerPool::work() {
  while (JobQueue::Job job = queue_.take()) {
    const double begun_s = clock_();
    ++busy_;
    try {
      job();
    } catch (...) {
      // Jobs report their own failures; one that cannot must not take the other sessions' work down with it.
      ++failed_;
    }
    job = nullptr;  // what the job holds is part of its time
    --busy_;
    busy_nanoseconds_ += static_cast<std::uint64_t>(std::llround(std::max(clock_() - begun_s, 0.0) * 1e9));
    ++jobs_;
  }
}

CastPool::CastPool(int threads, std::size_t queue_capacity, SecondsClock clock)
    : queue_(queue_capacity, clock),
      pool_(queue_, threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency()), clock) {}

PoolStatistics WorkerPool::statistics() const {
  return {.threads = static_cast<int>(threads_.size()),
          .busy = busy_.load(),
          .jobs = jobs_.load(),
          .failed = failed_.load(),
          .busy_seconds = static_cast<double>(busy_nanoseconds_.load()) * 1e-9};
}

}  // namespace farfield

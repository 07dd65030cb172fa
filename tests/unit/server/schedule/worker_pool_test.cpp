// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/worker_pool.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <future>
#include <latch>
#include <stdexcept>

namespace farfield {
namespace {

TEST(WorkerPool, RunsJobsOnAllItsThreads) {
  JobPool pool(2);
  std::latch both(2);  // passes only if two jobs run at the same time
  for (int i = 0; i < 2; ++i) pool.queue().push({}, [&both] { both.arrive_and_wait(); });
  both.wait();
  EXPECT_EQ(pool.pool_statistics().threads, 2);
}

TEST(WorkerPool, SurvivesAJobThatThrows) {
  JobPool pool(1);
  std::latch done(1);
  pool.queue().push({}, [] { throw std::runtime_error("oops"); });
  pool.queue().push({.seconds_until_needed = 1}, [&done] { done.count_down(); });
  done.wait();
  EXPECT_EQ(pool.pool_statistics().failed, 1u);
}

TEST(WorkerPool, CountsWorkedSeconds) {
  std::atomic<int> ticks{0};
  JobQueue queue(10);
  std::latch done(1);
  {
    WorkerPool pool(queue, 1, [&ticks] { return static_cast<double>(ticks++); });  // each look at the clock: a second
    queue.push({}, [] {});
    queue.push({}, [&done] { done.count_down(); });
    done.wait();
    while (pool.statistics().jobs < 2) std::this_thread::yield();
    EXPECT_DOUBLE_EQ(pool.statistics().busy_seconds, 2.0);
  }
}

TEST(WorkerPool, PausesBetweenJobs) {
  JobPool pool(2);
  std::atomic<int> begun{0}, ended{0};
  std::latch first(1), all(5);
  pool.queue().push({}, [&] {
    ++begun;
    first.count_down();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ++ended;
  });
  first.wait();
  pool.pause();
  EXPECT_EQ(ended, 1);  // it waited for the job that ran
  for (int i = 0; i < 5; ++i) {
    pool.queue().push({}, [&] {
      ++begun;
      all.count_down();
    });
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(begun, 1);
  pool.resume();
  all.wait();
  EXPECT_EQ(begun, 6);
}

TEST(WorkerPool, EndsWhilePaused) {
  JobPool pool(2);
  pool.pause();
  pool.queue().push({}, [] {});
}

TEST(WorkerPool, DestructionWaitsForTheRunningJobAndDropsTheRest) {
  std::atomic<int> ran{0};
  std::latch begun(1);
  {
    JobPool pool(1);
    pool.queue().push({}, [&] {
      begun.count_down();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      ++ran;
    });
    begun.wait();
    for (int i = 0; i < 50; ++i) {
      pool.queue().push({}, [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        ++ran;
      });
    }
  }
  EXPECT_GE(ran, 1);
  EXPECT_LT(ran, 50);
}

// What viewers wait for must not wait for what is being made.
TEST(WorkerPool, ThreadsAreAsNiceAsTheyAreToldAndOnlyThese) {
  const auto niceness = [](int nice) {
    JobPool pool(1, 10, steady_clock_seconds(), "test", nice);
    std::promise<int> found;
    pool.queue().push({}, [&] { found.set_value(getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()))); });
    return found.get_future().get();
  };
  const int own = getpriority(PRIO_PROCESS, 0);
  EXPECT_EQ(niceness(0), own);
  EXPECT_EQ(niceness(std::min(own + 10, 19)), std::min(own + 10, 19));
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), own);
}

}  // namespace
}  // namespace farfield

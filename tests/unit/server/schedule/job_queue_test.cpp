// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/job_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <thread>

namespace farfield {
namespace {

struct JobQueueTest : testing::Test {
  double now_s = 1000.0;
  std::string ran;
  JobQueue queue{100, [this] { return now_s; }};

  JobQueue::JobId push(char name, WorkPriority priority) {
    return queue.push(priority, [this, name] { ran += name; });
  }
  std::string run_all() {
    while (const auto job = queue.try_take()) job();
    return ran;
  }
};

TEST_F(JobQueueTest, SoonerNeededGoesFirst) {
  push('c', {.seconds_until_needed = 2});
  push('a', {.seconds_until_needed = 0});
  push('b', {.seconds_until_needed = 1});
  EXPECT_EQ(run_all(), "abc");
}

TEST_F(JobQueueTest, EquallySoonTheLargerShareOfTheViewGoesFirst) {
  push('b', {.view_share = 0.2f});
  push('c', {.view_share = 0.1f});
  push('a', {.view_share = 0.7f});
  push('d', {.view_share = 0.1f});  // and equal ones in the order they came
  EXPECT_EQ(run_all(), "abcd");
}

TEST_F(JobQueueTest, PrefetchComesAfterDemand) {
  push('p', {.seconds_until_needed = 0, .view_share = 1, .prefetch = true});
  push('d', {.seconds_until_needed = 4, .view_share = 0});
  EXPECT_EQ(run_all(), "dp");
}

TEST_F(JobQueueTest, TimePassedMovesWaitingWorkForward) {
  push('a', {.seconds_until_needed = 2});
  now_s += 1.5;
  push('b', {.seconds_until_needed = 1});  // due half a second after a
  EXPECT_EQ(run_all(), "ab");
}

TEST_F(JobQueueTest, NothingStarvesUnderSteadyDemand) {
  push('p', {.seconds_until_needed = 4, .prefetch = true});
  int taken = 0;
  while (ran.empty() && taken < 1000) {
    now_s += 0.05;
    queue.push({.view_share = 1}, [] {});
    queue.push({.view_share = 1}, [] {});
    queue.try_take()();
    ++taken;
  }
  EXPECT_EQ(ran, "p");
  // Demand grows by one job per round; the prefetch's turn comes with the demand of 12 seconds later.
  EXPECT_GT(taken, 240);
  EXPECT_LT(taken, 600);
}

TEST_F(JobQueueTest, ANearerNeedRaisesAJob) {
  const auto a = push('a', {.seconds_until_needed = 3, .prefetch = true});
  push('b', {.seconds_until_needed = 1});
  queue.raise(a, {.seconds_until_needed = 0});
  EXPECT_EQ(queue.statistics().queued_prefetch, 0u);
  EXPECT_EQ(run_all(), "ab");
}

TEST_F(JobQueueTest, AFartherNeedDoesNotLowerAJob) {
  const auto a = push('a', {.seconds_until_needed = 0});
  push('b', {.seconds_until_needed = 1});
  queue.raise(a, {.seconds_until_needed = 9, .prefetch = true});
  queue.raise(12345, {});  // unknown: nothing happens
  EXPECT_EQ(run_all(), "ab");
}

TEST_F(JobQueueTest, RemovedWorkDoesNotRun) {
  const auto a = push('a', {});
  push('b', {.prefetch = true});
  EXPECT_TRUE(queue.remove(a));
  EXPECT_FALSE(queue.remove(a));
  const QueueStatistics before = queue.statistics();
  EXPECT_EQ(before.queued, 1u);
  EXPECT_EQ(before.queued_prefetch, 1u);
  EXPECT_EQ(before.removed, 1u);
  EXPECT_EQ(run_all(), "b");
  EXPECT_EQ(queue.statistics().queued_prefetch, 0u);
}

TEST_F(JobQueueTest, IsBoundedAndKeepsRoomForDemand) {
  int accepted = 0;
  while (push('p', {.prefetch = true})) ++accepted;
  EXPECT_EQ(accepted, 75);
  while (push('d', {})) ++accepted;
  EXPECT_EQ(accepted, 100);
  EXPECT_EQ(queue.statistics().refused, 2u);
}

TEST_F(JobQueueTest, PrioritiesThatAreNoNumbersAreUrgentAndHarmless) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  push('c', {.seconds_until_needed = std::numeric_limits<double>::infinity()});
  push('a', {.seconds_until_needed = nan, .view_share = std::nanf("")});
  push('b', {.seconds_until_needed = 1});
  push('d', {.seconds_until_needed = -1e300, .view_share = 1});
  EXPECT_EQ(run_all(), "dabc");
}

TEST_F(JobQueueTest, OverdueWorkPassesWhatWasAskedForLatelyAndNothingOlder) {
  push('a', {});
  now_s += 1.5 * JobQueue::kMostOverdue_s;
  push('c', {});
  now_s += 0.5 * JobQueue::kMostOverdue_s;
  push('b', {.seconds_until_needed = -JobQueue::kMostOverdue_s});
  EXPECT_EQ(run_all(), "abc");
}

TEST_F(JobQueueTest, MeasuresWaiting) {
  push('a', {});
  now_s += 2;
  push('b', {});
  now_s += 1;
  EXPECT_DOUBLE_EQ(queue.statistics().oldest_wait_s, 3.0);
  run_all();
  EXPECT_DOUBLE_EQ(queue.statistics().longest_wait_s, 3.0);
  EXPECT_DOUBLE_EQ(queue.statistics().oldest_wait_s, 0.0);
}

TEST_F(JobQueueTest, CloseWakesWhoWaitsAndRefusesWork) {
  JobQueue open(10);
  bool was_empty = false;
  {
    std::jthread worker([&] { was_empty = !open.take(); });
    open.close();
  }
  EXPECT_TRUE(was_empty);
  EXPECT_EQ(open.push({}, [] {}), 0u);
  EXPECT_FALSE(open.try_take());
}

}  // namespace
}  // namespace farfield

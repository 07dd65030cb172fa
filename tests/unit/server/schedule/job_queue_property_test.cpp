// SPDX-License-Identifier: Apache-2.0
// The queue against a plain list searched from end to end: random pushes, raises, removals and takes as time passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <tuple>
#include <vector>

#include "server/schedule/job_queue.h"

namespace farfield {
namespace {

struct Listed {
  JobQueue::JobId id = 0;
  std::int64_t due_step = 0;
  float share = 0;
  bool is_before(const Listed& other) const {
    return std::make_tuple(due_step, -share, id) < std::make_tuple(other.due_step, -other.share, other.id);
  }
};

TEST(JobQueueProperty, AgreesWithASimpleListOnRandomUse) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(0, 1);
  double now_s = 50;
  JobQueue queue(200, [&now_s] { return now_s; });
  std::vector<Listed> list;
  JobQueue::JobId ran = 0;
  const auto random_priority = [&] {
    return WorkPriority{.seconds_until_needed = 5 * uniform(random),
                        .view_share = static_cast<float>(random() % 4) / 4.0f,
                        .prefetch = random() % 3 == 0};
  };
  const auto listed = [&](JobQueue::JobId id, const WorkPriority& priority) {
    const double due_s = now_s + priority.seconds_until_needed + (priority.prefetch ? JobQueue::kPrefetchDelay_s : 0.0);
    return Listed{id, static_cast<std::int64_t>(std::floor(due_s / JobQueue::kDueStep_s)), priority.view_share};
  };
  const auto any = [&] { return list.begin() + static_cast<std::ptrdiff_t>(random() % list.size()); };
  int taken = 0;
  for (int step = 0; step < 20'000; ++step) {
    now_s += 0.02 * uniform(random);
    const unsigned choice = random() % 8;
    if (choice < 3 && list.size() < 140) {
      const WorkPriority priority = random_priority();
      const auto next = std::make_shared<JobQueue::JobId>(0);
      *next = queue.push(priority, [&ran, next] { ran = *next; });
      ASSERT_NE(*next, 0u);
      list.push_back(listed(*next, priority));
    } else if (choice < 5 && !list.empty()) {
      const auto job = any();
      const WorkPriority priority = random_priority();
      queue.raise(job->id, priority);
      const Listed raised = listed(job->id, priority);
      if (raised.is_before(*job)) *job = raised;
    } else if (choice == 5 && !list.empty()) {
      const auto job = any();
      EXPECT_TRUE(queue.remove(job->id));
      list.erase(job);
    } else if (choice > 5) {
      const JobQueue::Job job = queue.try_take();
      ASSERT_EQ(static_cast<bool>(job), !list.empty());
      if (!job) continue;
      job();
      ++taken;
      const auto first =
          std::min_element(list.begin(), list.end(), [](const Listed& a, const Listed& b) { return a.is_before(b); });
      ASSERT_EQ(ran, first->id) << "at step " << step;
      list.erase(first);
    }
    ASSERT_EQ(queue.statistics().queued, list.size());
  }
  EXPECT_GT(taken, 3000);
}

}  // namespace
}  // namespace farfield

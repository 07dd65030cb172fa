// SPDX-License-Identifier: Apache-2.0
#include "server/store/single_flight.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

namespace farfield {
namespace {

struct Urgency {
  double seconds = 0;
  bool is_before(const Urgency& other) const { return seconds < other.seconds; }
};

// Jobs run when the test says so, on the test's thread.
class ManualQueue {
 public:
  using Priority = Urgency;
  std::uint64_t push(const Priority& priority, std::function<void()> job) {
    const std::scoped_lock lock(mutex_);
    if (jobs_.size() >= capacity) return 0;
    jobs_[++last_] = std::move(job);
    urgency[last_] = priority.seconds;
    return last_;
  }
  void raise(std::uint64_t id, const Priority& priority) {
    const std::scoped_lock lock(mutex_);
    urgency[id] = std::min(urgency[id], priority.seconds);
  }
  bool remove(std::uint64_t id) {
    const std::scoped_lock lock(mutex_);
    return jobs_.erase(id) > 0;
  }
  std::function<void()> take() {
    const std::scoped_lock lock(mutex_);
    if (jobs_.empty()) return {};
    auto job = std::move(jobs_.begin()->second);
    jobs_.erase(jobs_.begin());
    return job;
  }
  bool run_one() {
    const auto job = take();
    if (job) job();
    return static_cast<bool>(job);
  }
  std::size_t size() const { return jobs_.size(); }

  std::size_t capacity = 1000;
  std::map<std::uint64_t, double> urgency;

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::function<void()>> jobs_;
  std::uint64_t last_ = 0;
};

using Flights = SingleFlight<int, int, ManualQueue>;

struct SingleFlightTest : testing::Test {
  ManualQueue queue;
  Flights flights{queue};
  int made = 0;
  std::vector<Result<int>> answers;

  Flights::Make doubling(int key) {
    return [this, key](const CancelFlag&) -> Result<int> { return ++made, 2 * key; };
  }
  Flights::Answer collect() {
    return [this](Result<int> result) { answers.push_back(std::move(result)); };
  }
};

TEST_F(SingleFlightTest, AHundredRequestsCauseOneGeneration) {
  for (int i = 0; i < 100; ++i) flights.join(21, {}, doubling(21), collect());
  EXPECT_EQ(queue.size(), 1u);
  while (queue.run_one()) {
  }
  EXPECT_EQ(made, 1);
  ASSERT_EQ(answers.size(), 100u);
  for (const auto& answer : answers) EXPECT_EQ(answer.value(), 42);
  EXPECT_EQ(flights.size(), 0u);
  EXPECT_EQ(flights.statistics().shared, 99u);
}

TEST_F(SingleFlightTest, DifferentKeysAreMadeApart) {
  flights.join(1, {}, doubling(1), collect());
  flights.join(2, {}, doubling(2), collect());
  while (queue.run_one()) {
  }
  EXPECT_EQ(made, 2);
}

TEST_F(SingleFlightTest, AMoreUrgentRequestRaisesTheQueuedJob) {
  flights.join(1, {5.0}, doubling(1), collect());
  flights.join(1, {0.5}, doubling(1), collect());
  flights.join(1, {9.0}, doubling(1), collect());
  EXPECT_EQ(queue.urgency[1], 0.5);
}

TEST_F(SingleFlightTest, OneWithdrawalLeavesTheOthersWaiting) {
  const auto gone = flights.join(1, {}, doubling(1), collect());
  flights.join(1, {}, doubling(1), collect());
  flights.withdraw(1, gone);
  flights.withdraw(1, gone);  // idempotent
  while (queue.run_one()) {
  }
  EXPECT_EQ(answers.size(), 1u);
  EXPECT_EQ(made, 1);
}

TEST_F(SingleFlightTest, TheLastWithdrawalRemovesQueuedWork) {
  const auto a = flights.join(1, {}, doubling(1), collect());
  const auto b = flights.join(1, {}, doubling(1), collect());
  flights.withdraw(1, a);
  EXPECT_EQ(queue.size(), 1u);
  flights.withdraw(1, b);
  EXPECT_EQ(queue.size(), 0u);
  EXPECT_EQ(flights.size(), 0u);
  EXPECT_EQ(flights.statistics().cancelled, 1u);
  EXPECT_EQ(made, 0);
  EXPECT_TRUE(answers.empty());
}

TEST_F(SingleFlightTest, AJobTakenButNotBegunFindsNobodyWaiting) {
  const auto only = flights.join(1, {}, doubling(1), collect());
  const auto job = queue.take();
  flights.withdraw(1, only);
  job();
  EXPECT_EQ(made, 0);
  EXPECT_EQ(flights.size(), 0u);
}

TEST_F(SingleFlightTest, TheLastWithdrawalSetsTheFlagOfRunningWork) {
  Flights::Handle handle;
  bool was_set_before = true, was_set_after = false;
  handle = flights.join(
      1, {},
      [&](const CancelFlag& cancel) -> Result<int> {
        was_set_before = is_cancelled(cancel);
        flights.withdraw(1, handle);
        was_set_after = is_cancelled(cancel);
        return fail(ErrorCode::kCancelled, "nobody wants it");
      },
      collect());
  queue.run_one();
  EXPECT_FALSE(was_set_before);
  EXPECT_TRUE(was_set_after);
  EXPECT_TRUE(answers.empty());
  EXPECT_EQ(flights.size(), 0u);
  EXPECT_EQ(flights.statistics().failed, 0u);
}

TEST_F(SingleFlightTest, WhoJoinsCancelledWorkGetsATryOfHisOwn) {
  Flights::Handle first;
  int calls = 0;
  const Flights::Make make = [&](const CancelFlag& cancel) -> Result<int> {
    if (++calls == 1) {
      flights.withdraw(1, first);
      flights.join(1, {}, doubling(1), collect());
      EXPECT_TRUE(is_cancelled(cancel)) << "a set flag must stay set";
      return fail(ErrorCode::kCancelled, "cancelled");
    }
    EXPECT_FALSE(is_cancelled(cancel));
    return 7;
  };
  first = flights.join(1, {}, make, collect());
  queue.run_one();
  EXPECT_TRUE(answers.empty());
  EXPECT_EQ(queue.size(), 1u);
  queue.run_one();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].value(), 7);
}

TEST_F(SingleFlightTest, AFailureReachesAllWaitersAndIsTriedAgain) {
  const Flights::Make failing = [&](const CancelFlag&) -> Result<int> {
    ++made;
    return fail(ErrorCode::kIo, "the disk is full");
  };
  flights.join(1, {}, failing, collect());
  flights.join(1, {}, failing, collect());
  queue.run_one();
  ASSERT_EQ(answers.size(), 2u);
  for (const auto& answer : answers) EXPECT_EQ(answer.error().message, "the disk is full");
  EXPECT_EQ(flights.statistics().failed, 1u);
  flights.join(1, {}, doubling(1), collect());
  queue.run_one();
  EXPECT_EQ(answers.back().value(), 2);
}

TEST_F(SingleFlightTest, AnExceptionBecomesOneClearError) {
  flights.join(
      1, {}, [](const CancelFlag&) -> Result<int> { throw std::runtime_error("no more rays"); }, collect());
  flights.join(
      2, {}, [](const CancelFlag&) -> Result<int> { throw 5; }, collect());
  while (queue.run_one()) {
  }
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0].error().code, ErrorCode::kInternal);
  EXPECT_NE(answers[0].error().message.find("no more rays"), std::string::npos);
  EXPECT_EQ(answers[1].error().code, ErrorCode::kInternal);
}

TEST_F(SingleFlightTest, AFullQueueAnswersUnavailable) {
  queue.capacity = 1;
  flights.join(1, {}, doubling(1), collect());
  EXPECT_EQ(flights.join(2, {}, doubling(2), collect()), nullptr);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(flights.size(), 1u);
  EXPECT_EQ(flights.statistics().refused, 1u);
}

TEST_F(SingleFlightTest, AnAnswerMayAskAgain) {
  flights.join(1, {}, doubling(1), [&](Result<int> first) {
    answers.push_back(first);
    flights.join(1, {}, doubling(10), collect());
  });
  while (queue.run_one()) {
  }
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[1].value(), 20);
}

TEST(SingleFlightShutdown, WaitsForWhatRunsAndAnswersNobody) {
  ManualQueue queue;
  auto flights = std::make_unique<Flights>(queue);
  std::atomic<bool> has_begun{false}, has_ended{false}, was_answered{false};
  const auto answer = [&](Result<int>) { was_answered = true; };
  flights->join(
      1, {},
      [&](const CancelFlag& cancel) -> Result<int> {
        has_begun = true;
        while (!is_cancelled(cancel)) std::this_thread::yield();
        has_ended = true;
        return fail(ErrorCode::kCancelled, "cancelled");
      },
      answer);
  flights->join(
      2, {}, [](const CancelFlag&) -> Result<int> { return 1; }, answer);
  std::jthread worker([job = queue.take()] { job(); });
  while (!has_begun) std::this_thread::yield();
  flights.reset();
  EXPECT_TRUE(has_ended);
  EXPECT_FALSE(was_answered);
  EXPECT_EQ(queue.size(), 0u);
}

}  // namespace
}  // namespace farfield

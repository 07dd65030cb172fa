// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/job_queue.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>

namespace farfield {
namespace {

// Beyond any prediction's horizon; also what keeps the due step within its integer.
constexpr double kLongestUntilNeeded_s = 3600.0;

double bounded_seconds(double seconds) {
  if (std::isnan(seconds)) return 0.0;  // now
  return std::clamp(seconds, -JobQueue::kMostOverdue_s, kLongestUntilNeeded_s);
}

}  // namespace

SecondsClock steady_clock_seconds() {
  return [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
}

bool JobQueue::Rank::operator<(const Rank& other) const {
  return std::tie(due_step, minus_share, id) < std::tie(other.due_step, other.minus_share, other.id);
}

JobQueue::JobQueue(std::size_t capacity, SecondsClock clock) : clock_(std::move(clock)), capacity_(capacity) {}

JobQueue::Rank JobQueue::rank(const WorkPriority& priority, JobId id) const {
  const double due_s =
      clock_() + bounded_seconds(priority.seconds_until_needed) + (priority.prefetch ? kPrefetchDelay_s : 0.0);
  const float share = priority.view_share > 0 ? priority.view_share : 0.0f;  // NaN would break the order of the map
  return {static_cast<std::int64_t>(std::floor(due_s / kDueStep_s)), -share, id};
}

JobQueue::JobId JobQueue::push(const WorkPriority& priority, Job job) {
  JobId id = 0;
  {
    const std::scoped_lock lock(mutex_);
    const std::size_t room = priority.prefetch ? capacity_ - capacity_ / 4 : capacity_;
    if (is_closed_ || waiting_.size() >= room) {
      ++statistics_.refused;
      return 0;
    }
    id = ++last_id_;
    const Rank at = rank(priority, id);
    waiting_.emplace(at, Waiting{std::move(job), clock_(), priority.prefetch});
    ranks_.emplace(id, at);
    ++statistics_.pushed;
    statistics_.queued_prefetch += priority.prefetch ? 1 : 0;
  }
  pushed_.notify_one();
  return id;
}

void JobQueue::raise(JobId id, const WorkPriority& priority) {
  const std::scoped_lock lock(mutex_);
  const auto known = ranks_.find(id);
  if (known == ranks_.end()) return;
  auto node = waiting_.extract(known->second);
  if (node.mapped().is_prefetch && !priority.prefetch) {
    node.mapped().is_prefetch = false;
    --statistics_.queued_prefetch;
  }
  known->second = std::min(known->second, rank(priority, id));
  node.key() = known->second;
  waiting_.insert(std::move(node));
}

bool JobQueue::remove(JobId id) {
  Job dropped;  // destroyed after the lock is given back
  const std::scoped_lock lock(mutex_);
  const auto known = ranks_.find(id);
  if (known == ranks_.end()) return false;
  auto node = waiting_.extract(known->second);
  ranks_.erase(known);
  dropped = std::move(node.mapped().job);
  statistics_.queued_prefetch -= node.mapped().is_prefetch ? 1 : 0;
  ++statistics_.removed;
  return true;
}

JobQueue::Job JobQueue::take_first() {
  auto node = waiting_.extract(waiting_.begin());
  ranks_.erase(node.key().id);
  ++statistics_.taken;
  statistics_.queued_prefetch -= node.mapped().is_prefetch ? 1 : 0;
  statistics_.longest_wait_s = std::max(statistics_.longest_wait_s, clock_() - node.mapped().pushed_s);
  return std::move(node.mapped().job);
}

JobQueue::Job JobQueue::take() {
  std::unique_lock lock(mutex_);
  pushed_.wait(lock, [this] { return is_closed_ || !waiting_.empty(); });
  return is_closed_ ? Job() : take_first();
}

JobQueue::Job JobQueue::try_take() {
  const std::scoped_lock lock(mutex_);
  return is_closed_ || waiting_.empty() ? Job() : take_first();
}

void JobQueue::close() {
  {
    const std::scoped_lock lock(mutex_);
    is_closed_ = true;
  }
  pushed_.notify_all();
}

QueueStatistics JobQueue::statistics() const {
  const std::scoped_lock lock(mutex_);
  QueueStatistics result = statistics_;
  result.queued = waiting_.size();
  const double now = clock_();
  for (const auto& [rank, waiting] : waiting_) {
    result.oldest_wait_s = std::max(result.oldest_wait_s, now - waiting.pushed_s);
  }
  return result;
}

}  // namespace farfield

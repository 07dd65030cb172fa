// SPDX-License-Identifier: Apache-2.0
// Whatever the capacity and however requests, withdrawals and failures interleave: everyone who stays gets an answer,
// the bound holds, and no key is made twice at the same time.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <random>
#include <thread>
#include <vector>

#include "server/store/memory_tile_store.h"
#include "server/store/single_flight.h"

namespace farfield {
namespace {

struct Urgency {
  bool is_before(const Urgency&) const { return false; }
};

// First in, first out, with its own threads.
class ThreadedQueue {
 public:
  using Priority = Urgency;
  explicit ThreadedQueue(int threads) {
    for (int i = 0; i < threads; ++i) threads_.emplace_back([this](std::stop_token stop) { work(stop); });
  }
  ~ThreadedQueue() {
    for (auto& thread : threads_) thread.request_stop();
  }
  std::uint64_t push(const Priority&, std::function<void()> job) {
    const std::scoped_lock lock(mutex_);
    jobs_.emplace_back(++last_, std::move(job));
    changed_.notify_one();
    return last_;
  }
  void raise(std::uint64_t, const Priority&) {}
  bool remove(std::uint64_t id) {
    const std::scoped_lock lock(mutex_);
    return std::erase_if(jobs_, [id](const auto& job) { return job.first == id; }) > 0;
  }

 private:
  void work(const std::stop_token& stop) {
    for (;;) {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [this] { return !jobs_.empty(); })) return;
      const auto job = std::move(jobs_.front().second);
      jobs_.pop_front();
      lock.unlock();
      job();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::pair<std::uint64_t, std::function<void()>>> jobs_;
  std::uint64_t last_ = 0;
  std::vector<std::jthread> threads_;
};

constexpr int kKeys = 24;

struct Workload {
  explicit Workload(std::size_t capacity) : store(capacity) {}

  ThreadedQueue queue{2};
  MemoryTileStore store;
  std::array<std::atomic<int>, kKeys> being_made{};
  std::atomic<int> answered{0}, expected{0}, withdrawn{0}, overlaps{0};
  SingleFlight<int, SharedTile, ThreadedQueue> flights{queue};  // first to go: it needs all of the above

  static TileKey key_of(int key) { return {1, {.cell = {.x = key}}}; }

  Result<SharedTile> make(int key, const CancelFlag& cancel) {
    if (const SharedTile known = store.peek(key_of(key))) return known;
    if (being_made[key].fetch_add(1) != 0) ++overlaps;
    std::this_thread::yield();
    Result<SharedTile> result;
    if (is_cancelled(cancel)) {
      result = fail(ErrorCode::kCancelled, "cancelled");
    } else if (key % 7 == 3) {
      result = fail(ErrorCode::kInternal, "this one never works");
    } else {
      auto tile = std::make_shared<EncodedTile>();
      tile->bytes = std::make_shared<const Bytes>(static_cast<std::size_t>(key) * 20);
      result = tile;
    }
    being_made[key].fetch_sub(1);
    if (result) store.insert(key_of(key), *result);
    return result;
  }

  void request_at_random(unsigned seed, int count) {
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
      const int key = static_cast<int>(random() % kKeys);
      if (const SharedTile hit = store.find(key_of(key))) {
        EXPECT_EQ(hit->bytes->size(), static_cast<std::size_t>(key) * 20);
        continue;
      }
      // Answered and withdrawn exclude each other only if the withdrawal came first: count each request once.
      const auto counted = std::make_shared<std::atomic<bool>>(false);
      ++expected;
      const auto handle = flights.join(
          key, {}, [this, key](const CancelFlag& cancel) { return make(key, cancel); },
          [this, key, counted](const Result<SharedTile>& result) {
            EXPECT_EQ(result.has_value(), key % 7 != 3);
            if (!counted->exchange(true)) ++answered;
          });
      if (random() % 4 == 0) {
        flights.withdraw(key, handle);
        if (!counted->exchange(true)) ++withdrawn;
      }
    }
  }
};

TEST(StoreProperty, EveryRequestEndsAndEachKeyIsMadeOnceAtATime) {
  std::mt19937 random(11);
  const std::size_t one_item = 700 + ByteBoundedLru<TileKey, SharedTile>::kEntryOverheadBytes;
  for (int round = 0; round < 12; ++round) {
    const std::size_t capacity = one_item + random() % 6000;
    Workload workload(capacity);
    {
      std::vector<std::jthread> viewers;
      for (unsigned v = 0; v < 3; ++v) {
        viewers.emplace_back(
            [&workload, v, round] { workload.request_at_random(100u * static_cast<unsigned>(round) + v, 400); });
      }
    }
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (workload.answered + workload.withdrawn < workload.expected && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::yield();
    }
    EXPECT_EQ(workload.answered + workload.withdrawn, workload.expected) << "capacity " << capacity;
    EXPECT_EQ(workload.overlaps, 0);
    EXPECT_LE(workload.store.statistics().bytes, capacity);
    EXPECT_GT(workload.answered, 0);
  }
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Services of several servers that share one Redis server: each thing is made once, whoever asks, and nobody waits for the dead.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "server/schedule/lease_waits.h"
#include "server/store/memory_tile_store.h"
#include "server/store/redis_lease.h"
#include "tests/support/redis_server.h"
#include "tests/unit/server/schedule/fake_sources.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

/// One server: memory, pools and sources of its own.
struct Peer {
  explicit Peer(const TestRedis& redis) {
    client = std::make_shared<RedisClient>(RedisClientOptions{.address = redis.address(), .longest_pause = 200ms});
    blobs = std::make_shared<RedisStore>(client, RedisStoreOptions{});
    lease = std::make_shared<RedisLease>(client, blobs);
    SceneDescription scene;
    scene.hash = 77;
    scene.settings.finest_side_m = 1.0;
    service = make_cell_service({.scene = scene, .geometry = std::make_shared<const FakeGeometry>(), .leaves = leaves, .tiles = tiles,
                                 .store = std::make_shared<MemoryTileStore>(1 << 20), .pool = pool, .blobs = blobs, .lease = lease,
                                 .prompt_pool = prompt_pool});
  }
  static TileId tile_id(std::uint8_t x) { return {.cell = {.level = 1}, .x = x}; }
  Ticket ask(std::uint8_t x) {
    return service->tile(tile_id(x), {}, [this](Result<SharedTile> tile) { answers += tile && *tile ? 1 : 0; });
  }
  Ticket ask(const glm::dvec3& viewpoint) {
    return service->leaf(viewpoint, {}, [this](Result<SharedPlan> plan) { answers += plan && *plan ? 1 : 0; });
  }

  std::shared_ptr<RedisClient> client;
  std::shared_ptr<RedisStore> blobs;
  std::shared_ptr<RedisLease> lease;
  std::shared_ptr<FakeLeaves> leaves = std::make_shared<FakeLeaves>();
  std::shared_ptr<FakeTiles> tiles = std::make_shared<FakeTiles>();
  std::shared_ptr<JobPool> pool = std::make_shared<JobPool>(2);
  std::shared_ptr<JobPool> prompt_pool = std::make_shared<JobPool>(2, JobPool::kDefaultQueueCapacity, steady_clock_seconds(), "prompt");
  std::atomic<int> answers{0};
  std::unique_ptr<MeasuredCellService> service;
};

class SharedCells : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(redis_.is_there()) << "redis-server (Debian's package) does not start"; }
  TestRedis redis_;
};

TEST_F(SharedCells, EachTileIsMadeByOneOfThem) {
  Peer first(redis_), second(redis_);
  std::vector<Ticket> tickets;
  for (std::uint8_t x = 0; x < 100; ++x) tickets.push_back(first.ask(x)), tickets.push_back(second.ask(static_cast<std::uint8_t>(99 - x)));
  ASSERT_TRUE(eventually([&] { return first.answers == 100 && second.answers == 100; }));
  EXPECT_EQ(first.tiles->made + second.tiles->made, 100);
  const TurnStatistics turns[] = {first.service->statistics().turns, second.service->statistics().turns};
  EXPECT_EQ(turns[0].leases + turns[1].leases, 100u);
  EXPECT_EQ(turns[0].alone + turns[1].alone, 0u);
  EXPECT_EQ(first.blobs->statistics().rewritten + second.blobs->statistics().rewritten, 0u);
}

TEST_F(SharedCells, EachLeafIsPlannedByOneOfThem) {
  Peer first(redis_), second(redis_);
  std::vector<Ticket> tickets;
  std::set<CellId> leaves;
  for (int x = 0; x < 20; ++x) {
    leaves.insert(first.leaves->grid.cell_at({2 * x, 0.5, 0.5}, 1));
    tickets.push_back(first.ask({2 * x, 0.5, 0.5})), tickets.push_back(second.ask({2 * x, 0.5, 0.5}));
  }
  ASSERT_TRUE(eventually([&] { return first.answers == 20 && second.answers == 20; }));
  EXPECT_EQ(first.leaves->plans + second.leaves->plans, static_cast<int>(leaves.size()));
  EXPECT_EQ(first.service->statistics().plans_made + second.service->statistics().plans_made, leaves.size());
}

TEST_F(SharedCells, WhoWaitsKeepsNoThreadAndIsAnsweredWhenItIsMade) {
  Peer first(redis_), second(redis_);
  std::latch gate(1);
  first.tiles->gate = &gate;
  const Ticket made = first.ask(1), also_made = first.ask(2);
  ASSERT_TRUE(eventually([&] { return first.tiles->made == 2; }));
  std::vector<Ticket> waiting;
  waiting.push_back(second.ask(1)), waiting.push_back(second.ask(2));
  ASSERT_TRUE(eventually([&] { return second.service->statistics().turns.waits == 2; }));
  const Ticket other = second.ask(3);
  EXPECT_TRUE(eventually([&] { return second.answers == 1; })) << "with both casting threads free";
  gate.count_down();
  EXPECT_TRUE(eventually([&] { return second.answers == 3; }));
  EXPECT_EQ(second.tiles->made, 1);
  EXPECT_EQ(second.service->statistics().turns.waits_in_vain, 0u);
}

// A server that was killed leaves its leases to end by themselves.
TEST_F(SharedCells, WhatADeadServerWasMakingIsMadeByAnother) {
  const std::array<ContentHash, 2> parts{77, kImpostorVersion};
  const BlobKey key{.world = hash_values(std::span<const ContentHash>(parts)), .name = Peer::tile_id(1)};
  redis_.ask({"SET", redis_key(key, 'l'), "dead", "PX", "1000"});
  Peer second(redis_);
  const Ticket waiting = second.ask(1);
  ASSERT_TRUE(eventually([&] { return second.service->statistics().turns.waits == 1; }));
  EXPECT_EQ(second.tiles->made, 0);
  EXPECT_TRUE(eventually([&] { return second.answers == 1; }));
  EXPECT_EQ(second.tiles->made, 1);
  EXPECT_EQ(second.service->statistics().turns.waits_in_vain, 1u);
}

TEST_F(SharedCells, WhatAnotherGaveUpIsMade) {
  Peer first(redis_), second(redis_);
  first.tiles->is_blocking = true;
  Ticket given_up = first.ask(1);
  ASSERT_TRUE(eventually([&] { return first.tiles->made == 1; }));
  const Ticket waiting = second.ask(1);
  ASSERT_TRUE(eventually([&] { return second.service->statistics().turns.waits == 1; }));
  given_up.release();
  EXPECT_TRUE(eventually([&] { return second.answers == 1; }));
  EXPECT_EQ(second.tiles->made, 1);
}

TEST_F(SharedCells, WhoNoLongerWaitsIsForgotten) {
  Peer first(redis_), second(redis_);
  first.tiles->is_blocking = true;
  Ticket making = first.ask(1);
  ASSERT_TRUE(eventually([&] { return first.tiles->made == 1; }));
  Ticket waiting = second.ask(1);
  ASSERT_TRUE(eventually([&] { return second.service->statistics().turns.waits == 1; }));
  waiting.release();
  making.release();
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(second.tiles->made, 0);
  EXPECT_EQ(second.answers, 0);
}

TEST_F(SharedCells, WithoutRedisEveryoneMakesTheirOwn) {
  Peer first(redis_), second(redis_);
  first.tiles->is_blocking = true;
  Ticket making = first.ask(1);
  ASSERT_TRUE(eventually([&] { return first.tiles->made == 1; }));
  const Ticket waiting = second.ask(1);
  ASSERT_TRUE(eventually([&] { return second.service->statistics().turns.waits == 1; }));
  redis_.kill_now();
  EXPECT_TRUE(eventually([&] { return second.answers == 1; })) << "nobody can tell any more whether it is being made";
  const Ticket next = second.ask(2);
  EXPECT_TRUE(eventually([&] { return second.answers == 2; }));
  EXPECT_EQ(second.service->statistics().turns.alone, 2u);
  making.release();
}

TEST_F(SharedCells, DestroyedWhileItWaits) {
  Peer first(redis_);
  first.tiles->is_blocking = true;
  Ticket making = first.ask(1);
  ASSERT_TRUE(eventually([&] { return first.tiles->made == 1; }));
  {
    Peer second(redis_);
    Ticket waiting = second.ask(1);
    ASSERT_TRUE(eventually([&] { return second.service->statistics().turns.waits == 1; }));
    waiting.release();
  }
  making.release();
}

// ── the waits alone ──

struct FakeLease : GenerationLease {
  Turn acquire(const BlobKey&) override { return Turn::kTheirs; }
  void release(const BlobKey&) override {}
  std::vector<bool> are_held(std::span<const BlobKey> keys) override {
    ++looks;
    return std::vector<bool>(keys.size(), is_held);
  }
  std::atomic<bool> is_held{true};
  std::atomic<int> looks{0};
};

TEST(LeaseWaits, AsksForAllAtOnceAndOnlyWhileSomebodyWaits) {
  const auto lease = std::make_shared<FakeLease>();
  LeaseWaits waits(lease);
  std::atomic<int> ended{0};
  const auto later = LeaseWaits::Clock::now() + 1h;
  for (int k = 0; k < 300; ++k) waits.wait({.name = {.cell = {.x = k}}}, later, [&] { ++ended; });
  ASSERT_TRUE(eventually([&] { return lease->looks >= 3; }));
  EXPECT_EQ(ended, 0);
  lease->is_held = false;
  ASSERT_TRUE(eventually([&] { return ended == 300; }));
  EXPECT_EQ(waits.size(), 0u);
  const int looks = lease->looks;
  std::this_thread::sleep_for(60ms);
  EXPECT_EQ(lease->looks, looks);
}

TEST(LeaseWaits, PatienceEndsAndWithdrawnWaitsDoNot) {
  const auto lease = std::make_shared<FakeLease>();
  LeaseWaits waits(lease);
  std::atomic<int> ended{0}, withdrawn{0};
  const auto handle = waits.wait({.name = {.x = 1}}, LeaseWaits::Clock::now(), [&] { ++withdrawn; });
  waits.withdraw(handle);
  waits.wait({.name = {.x = 1}}, LeaseWaits::Clock::now(), [&] { ++ended; });
  EXPECT_TRUE(eventually([&] { return ended == 1; }));
  EXPECT_EQ(withdrawn, 0);
  waits.stop();
  waits.wait({.name = {.x = 2}}, LeaseWaits::Clock::now(), [&] { ++ended; });
  EXPECT_EQ(waits.size(), 0u);
}

}  // namespace
}  // namespace farfield

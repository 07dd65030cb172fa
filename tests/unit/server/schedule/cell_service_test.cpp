// SPDX-License-Identifier: Apache-2.0
// The service with fake sources: every answer arrives, each thing is made once, and what nobody wants is cancelled.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <latch>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>

#include "server/schedule/scheduled_cell_service.h"
#include "server/store/memory_tile_store.h"
#include "tests/unit/server/schedule/fake_sources.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

struct CellServiceTest : testing::Test {
  std::shared_ptr<FakeLeaves> leaves = std::make_shared<FakeLeaves>();
  std::shared_ptr<FakeTiles> tiles = std::make_shared<FakeTiles>();
  std::shared_ptr<MemoryTileStore> store = std::make_shared<MemoryTileStore>(1 << 20);
  std::shared_ptr<JobPool> pool = std::make_shared<JobPool>(2);
  std::unique_ptr<MeasuredCellService> service = make();

  std::unique_ptr<MeasuredCellService> make() {
    SceneDescription scene;
    scene.hash = 77;
    scene.settings.finest_side_m = 1.0;
    return make_cell_service({.scene = scene,
                              .geometry = std::make_shared<const FakeGeometry>(),
                              .leaves = leaves,
                              .tiles = tiles,
                              .store = store,
                              .pool = pool});
  }
  static TileId tile_id(std::uint8_t x, std::uint8_t face = 0) { return {.cell = {.level = 1}, .face = face, .x = x}; }
};

TEST_F(CellServiceTest, ATileIsMadeOnceForAHundredThreads) {
  std::latch gate(1);
  tiles->gate = &gate;
  std::atomic<int> answers{0};
  std::vector<Ticket> tickets(100);
  {
    std::vector<std::jthread> viewers;
    for (int i = 0; i < 100; ++i) {
      viewers.emplace_back([&, i] {
        tickets[static_cast<std::size_t>(i)] = service->tile(
            tile_id(7), {}, [&](Result<SharedTile> tile) { answers += tile && (*tile)->bytes->size() == 107 ? 1 : 0; });
      });
    }
  }
  gate.count_down();
  EXPECT_TRUE(eventually([&] { return answers == 100; }));
  EXPECT_EQ(tiles->made, 1);
  EXPECT_EQ(service->statistics().tile_flights.shared, 99u);
}

TEST_F(CellServiceTest, AStoredTileIsAnsweredAtOnce) {
  std::atomic<bool> has_first{false};
  const Ticket first = service->tile(tile_id(1), {}, [&](Result<SharedTile>) { has_first = true; });
  ASSERT_TRUE(eventually([&] { return has_first.load(); }));
  bool is_answered = false;
  const Ticket second = service->tile(tile_id(1), {}, [&](Result<SharedTile> tile) { is_answered = tile.has_value(); });
  EXPECT_TRUE(is_answered);
  EXPECT_EQ(tiles->made, 1);
  EXPECT_EQ(store->statistics().hits, 1u);
  EXPECT_EQ(store->statistics().misses, 1u);
}

TEST_F(CellServiceTest, DroppingTheLastTicketCancelsRunningWork) {
  tiles->is_blocking = true;
  std::atomic<bool> is_answered{false};
  auto ticket = service->tile(tile_id(1), {}, [&](Result<SharedTile>) { is_answered = true; });
  auto other = service->tile(tile_id(1), {}, [&](Result<SharedTile>) { is_answered = true; });
  ASSERT_TRUE(eventually([&] { return tiles->made == 1; }));
  ticket.release();
  std::this_thread::sleep_for(5ms);
  EXPECT_EQ(tiles->cancelled, 0) << "one viewer still waits";
  other.release();
  EXPECT_TRUE(eventually([&] { return tiles->cancelled == 1; }));
  EXPECT_FALSE(is_answered);
}

TEST_F(CellServiceTest, DroppedTicketsTakeQueuedWorkWithThem) {
  tiles->is_blocking = true;
  std::vector<Ticket> busy;
  for (std::uint8_t x = 0; x < 2; ++x) busy.push_back(service->tile(tile_id(x), {}, [](Result<SharedTile>) {}));
  ASSERT_TRUE(eventually([&] { return tiles->made == 2; }));
  std::vector<Ticket> waiting;
  for (std::uint8_t x = 10; x < 60; ++x) {
    waiting.push_back(service->tile(tile_id(x), {.prefetch = true}, [](Result<SharedTile>) {}));
  }
  EXPECT_EQ(service->statistics().queue.queued, 50u);
  waiting.clear();
  EXPECT_EQ(service->statistics().queue.queued, 0u);
  EXPECT_EQ(tiles->made, 2);
}

TEST_F(CellServiceTest, FailuresAndExceptionsReachWhoAskedAndAreTriedAgain) {
  for (const std::uint8_t face : {4, 5}) {
    for (int attempt = 1; attempt <= 2; ++attempt) {
      std::atomic<bool> is_done{false};
      ErrorCode code = ErrorCode::kIo;
      const Ticket ticket = service->tile(tile_id(0, face), {}, [&](Result<SharedTile> tile) {
        code = tile ? ErrorCode::kIo : tile.error().code;
        is_done = true;
      });
      ASSERT_TRUE(eventually([&] { return is_done.load(); }));
      EXPECT_EQ(code, ErrorCode::kInternal);
    }
  }
  EXPECT_EQ(tiles->made, 4);
}

TEST_F(CellServiceTest, ALeafNobodyCanStandInIsPlannedForWhoIsThereAndNotAhead) {
  leaves->is_blocked = true;
  const glm::dvec3 viewpoint(0.5, 0.5, 0.5);
  const auto ask = [&](const WorkPriority& priority) {
    std::atomic<bool> is_done{false};
    ErrorCode code = ErrorCode::kInternal;
    bool is_planned = false;
    const Ticket ticket = service->leaf(viewpoint, priority, [&](Result<SharedPlan> plan) {
      is_planned = plan.has_value();
      if (!plan) code = plan.error().code;
      is_done = true;
    });
    EXPECT_TRUE(eventually([&] { return is_done.load(); }));
    return is_planned ? std::nullopt : std::optional<ErrorCode>(code);
  };
  EXPECT_EQ(ask({.prefetch = true}), ErrorCode::kNotFound);
  EXPECT_EQ(leaves->plans, 0);
  EXPECT_EQ(ask({}), std::nullopt) << "somebody is there";
  EXPECT_EQ(leaves->stood, 1) << "and is not asked whether they can be";
  EXPECT_EQ(leaves->plans, 1);
  EXPECT_EQ(ask({.prefetch = true}), std::nullopt) << "known already";
}

TEST_F(CellServiceTest, ALeafIsPlannedOnceForAllViewpointsInIt) {
  std::latch gate(1);
  leaves->gate = &gate;
  std::atomic<int> answers{0};
  std::set<CellId> names;
  std::mutex mutex;
  std::vector<Ticket> tickets;
  for (int i = 0; i < 30; ++i) {  // four finest cells of one leaf: level 1 has one from -1 to 1
    tickets.push_back(service->leaf({i % 2 - 0.5, i % 4 / 2 - 0.5, 0.5}, {}, [&](Result<SharedPlan> plan) {
      const std::scoped_lock lock(mutex);
      if (plan) names.insert((*plan)->leaf);
      ++answers;
    }));
  }
  gate.count_down();
  ASSERT_TRUE(eventually([&] { return answers == 30; }));
  const std::scoped_lock lock(mutex);
  EXPECT_EQ(names, std::set<CellId>{leaves->grid.cell_at({0.5, 0.5, 0.5}, 1)});
  EXPECT_EQ(leaves->plans, 1);
}

TEST_F(CellServiceTest, AKnownLeafIsAnsweredAtOnceFromAnyOfItsViewpoints) {
  std::atomic<bool> has_first{false};
  const Ticket first = service->leaf({0.5, 0.5, 0.5}, {}, [&](Result<SharedPlan>) { has_first = true; });
  ASSERT_TRUE(eventually([&] { return has_first.load(); }));
  bool is_answered = false;
  const Ticket second =
      service->leaf({-0.9, 0.1, -0.2}, {}, [&](Result<SharedPlan> plan) { is_answered = plan.has_value(); });
  EXPECT_TRUE(is_answered);
  EXPECT_EQ(leaves->searches, 1);
}

TEST_F(CellServiceTest, ALeafRequestCanBeWithdrawnInItsSecondHalf) {
  leaves->is_blocking = true;
  std::atomic<bool> is_answered{false};
  auto ticket = service->leaf({0.5, 0.5, 0.5}, {}, [&](Result<SharedPlan>) { is_answered = true; });
  ASSERT_TRUE(eventually([&] { return leaves->plans == 1; }));
  ticket.release();
  EXPECT_TRUE(eventually([&] { return leaves->cancelled == 1; }));
  EXPECT_FALSE(is_answered);
}

TEST_F(CellServiceTest, ViewpointsThatAreNoPlacesAreRefused) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ErrorCode code = ErrorCode::kIo;
    const Ticket ticket = service->leaf({0, bad, 0}, {}, [&](Result<SharedPlan> plan) { code = plan.error().code; });
    EXPECT_EQ(code, ErrorCode::kInvalidArgument);
  }
}

TEST_F(CellServiceTest, GeometryIsAnsweredAndItsIndicesAreChecked) {
  std::atomic<int> bytes{0}, refused{0};
  const auto count = [&](Result<SharedBytes> result) {
    if (result) bytes += static_cast<int>((*result)->size());
    if (!result && result.error().code == ErrorCode::kNotFound) ++refused;
  };
  const Ticket a = service->chunk(2, {}, count);             // 3 bytes
  const Ticket b = service->texture_level(0, 1, {}, count);  // 11
  const Ticket c = service->chunk(3, {}, count);
  const Ticket d = service->texture_level(0, 2, {}, count);
  const Ticket e = service->texture_level(1, 0, {}, count);
  EXPECT_TRUE(eventually([&] { return bytes == 14; }));
  EXPECT_EQ(refused, 3);
}

TEST_F(CellServiceTest, CellsReportWhatTheyCost) {
  std::atomic<int> answers{0};
  std::vector<Ticket> tickets;
  for (std::uint8_t x = 0; x < 3; ++x)
    tickets.push_back(service->tile(tile_id(x), {}, [&](Result<SharedTile>) { ++answers; }));
  tickets.push_back(service->leaf({0.5, 0.5, 0.5}, {}, [&](Result<SharedPlan>) { ++answers; }));
  ASSERT_TRUE(eventually([&] { return answers == 4; }));
  const auto cells = service->cell_statistics();
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].tiles, 3u);
  EXPECT_EQ(cells[0].bytes, 303u);
  EXPECT_NEAR(cells[0].seconds, 0.03, 1e-12);
  EXPECT_NEAR(cells[0].stages.intra, 0.006, 1e-12);
  EXPECT_TRUE(cells[1].is_leaf);
  EXPECT_EQ(service->statistics().tile_seconds.count, 3u);
}

TEST_F(CellServiceTest, DestroyingTheServiceWaitsForItsCancelledWork) {
  tiles->is_blocking = true;
  std::vector<Ticket> tickets;
  for (std::uint8_t x = 0; x < 20; ++x) tickets.push_back(service->tile(tile_id(x), {}, [](Result<SharedTile>) {}));
  ASSERT_TRUE(eventually([&] { return tiles->made == 2; }));
  tickets.clear();
  service.reset();
  EXPECT_EQ(tiles->cancelled, tiles->made);
  EXPECT_LT(tiles->made, 20);
  EXPECT_EQ(pool->queue_statistics().queued, 0u);
}

// ── with a tier that outlives the service ──

// A map, read slowly if asked to.
struct FakeBlobs : BlobStore {
  SharedBytes find(const BlobKey& key) override {
    ++asked;
    if (gate) gate->wait();
    const std::scoped_lock lock(mutex);
    const auto at = blobs.find(key);
    return at == blobs.end() ? nullptr : at->second;
  }
  void insert(const BlobKey& key, SharedBytes bytes) override {
    const std::scoped_lock lock(mutex);
    blobs[key] = std::move(bytes);
  }
  Status flush() override { return {}; }
  BlobStoreStatistics statistics() const override { return {}; }
  std::size_t size() const {
    const std::scoped_lock lock(mutex);
    return blobs.size();
  }
  mutable std::mutex mutex;
  std::map<BlobKey, SharedBytes> blobs;
  std::latch* gate = nullptr;
  std::atomic<int> asked{0};
};

struct StoredServiceTest : CellServiceTest {
  std::shared_ptr<FakeBlobs> blobs = std::make_shared<FakeBlobs>();
  std::shared_ptr<JobPool> prompt_pool = std::make_shared<JobPool>(2, JobPool::kDefaultQueueCapacity, steady_clock_seconds(), "prompt");

  // As after a restart: nothing in memory.
  void restart(ContentHash hash = 77) {
    service.reset();
    store = std::make_shared<MemoryTileStore>(1 << 20);
    SceneDescription scene;
    scene.hash = hash;
    scene.settings.finest_side_m = 1.0;
    service = make_cell_service({.scene = scene, .geometry = std::make_shared<const FakeGeometry>(), .leaves = leaves, .tiles = tiles,
                                 .store = store, .pool = pool, .blobs = blobs, .prompt_pool = prompt_pool});
    blobs->asked = 0;  // not what it asks for to begin with
  }
  SharedTile tile_now(std::uint8_t x) {
    std::atomic<bool> is_answered{false};
    SharedTile result;
    const Ticket ticket = service->tile(tile_id(x), {}, [&](Result<SharedTile> tile) {
      if (tile) result = *tile;
      is_answered = true;
    });
    EXPECT_TRUE(eventually([&] { return is_answered.load(); }));
    return result;
  }
  Result<SharedPlan> plan_now(const glm::dvec3& viewpoint, const WorkPriority& priority = {}) {
    std::atomic<bool> is_answered{false};
    Result<SharedPlan> result;
    const Ticket ticket = service->leaf(viewpoint, priority, [&](Result<SharedPlan> plan) {
      result = std::move(plan);
      is_answered = true;
    });
    EXPECT_TRUE(eventually([&] { return is_answered.load(); }));
    return result;
  }
};

TEST_F(StoredServiceTest, ARestartedServiceMakesNothingAgain) {
  restart();
  ASSERT_TRUE(tile_now(7));
  const Result<SharedPlan> before = plan_now({0.5, 0.5, 0.5});
  ASSERT_TRUE(before);
  restart();
  const SharedTile tile = tile_now(7);
  ASSERT_TRUE(tile);
  EXPECT_EQ(tile->bytes->size(), 107u);
  const Result<SharedPlan> after = plan_now({0.5, 0.5, 0.5});
  ASSERT_TRUE(after);
  EXPECT_EQ((*after)->leaf, (*before)->leaf);
  EXPECT_EQ(tiles->made, 1);
  EXPECT_EQ(leaves->plans, 1);
  EXPECT_EQ(leaves->searches, 1);
  // Another finest cell of the same leaf: only its name is new.
  ASSERT_TRUE(plan_now({0.5, 0.5, -0.5}));
  EXPECT_EQ(leaves->plans, 1);
}

TEST_F(StoredServiceTest, AStoredPlanIsFoundFromACellOfItsLeafThatNobodyAskedFromBefore) {
  restart();
  ASSERT_TRUE(plan_now({0.5, 0.5, 0.5}));
  restart();
  ASSERT_TRUE(plan_now({0.5, 0.5, -0.5}));
  EXPECT_EQ(leaves->plans, 1);
}

TEST_F(StoredServiceTest, WhatWasFetchedIsInMemoryAfterwards) {
  restart();
  tile_now(7), restart(), tile_now(7);
  const int asked = blobs->asked;
  EXPECT_TRUE(tile_now(7));
  EXPECT_EQ(blobs->asked, asked);
}

TEST_F(StoredServiceTest, AChangedModelIsServedNothingOfTheOldOne) {
  restart();
  tile_now(7), (void)plan_now({0.5, 0.5, 0.5});
  restart(78);
  tile_now(7), (void)plan_now({0.5, 0.5, 0.5});
  EXPECT_EQ(tiles->made, 2);
  EXPECT_EQ(leaves->plans, 2);
}

TEST_F(StoredServiceTest, WhatCannotBeReadIsMadeAgainAndRepaired) {
  restart();
  tile_now(7), (void)plan_now({0.5, 0.5, 0.5});
  const std::size_t size = blobs->size();
  for (auto& [key, bytes] : blobs->blobs) bytes = std::make_shared<const Bytes>(Bytes{9, 9, 9});
  restart();
  EXPECT_TRUE(tile_now(7));
  EXPECT_TRUE(plan_now({0.5, 0.5, 0.5}));
  EXPECT_EQ(tiles->made, 2);
  EXPECT_EQ(leaves->plans, 2);
  EXPECT_EQ(blobs->size(), size);
  restart();
  EXPECT_TRUE(tile_now(7));
  EXPECT_EQ(tiles->made, 2) << "repaired";
}

TEST_F(StoredServiceTest, BlockedLeavesStayBlockedForThoseAheadAndOpenForThoseThere) {
  leaves->is_blocked = true;
  restart();
  const WorkPriority ahead{.prefetch = true};
  EXPECT_FALSE(plan_now({0.5, 0.5, 0.5}, ahead));
  restart();
  const Result<SharedPlan> blocked = plan_now({0.5, 0.5, 0.5}, ahead);
  ASSERT_FALSE(blocked);
  EXPECT_EQ(blocked.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(leaves->stood, 1);
  EXPECT_TRUE(plan_now({0.5, 0.5, 0.5}));
}

TEST_F(StoredServiceTest, ReleasedWhileItIsFetchedItIsNeverMade) {
  std::latch gate(1);
  restart();
  blobs->gate = &gate;
  Ticket tile = service->tile(tile_id(9), {}, [](Result<SharedTile>) {});
  Ticket leaf = service->leaf({0.5, 0.5, 0.5}, {}, [](Result<SharedPlan>) {});
  ASSERT_TRUE(eventually([&] { return blobs->asked == 2; }));
  tile.release(), leaf.release();
  gate.count_down();
  blobs->gate = nullptr;
  EXPECT_TRUE(tile_now(10));
  EXPECT_EQ(tiles->made, 1) << "only the one asked for since";
  EXPECT_EQ(leaves->searches, 0);
}

TEST_F(StoredServiceTest, AHundredThreadsFetchOnceAndMakeOnce) {
  std::latch gate(1);
  restart();
  blobs->gate = &gate;
  std::atomic<int> answers{0};
  std::vector<Ticket> tickets(100);
  {
    std::vector<std::jthread> viewers;
    for (std::size_t i = 0; i < tickets.size(); ++i)
      viewers.emplace_back([&, i] { tickets[i] = service->tile(tile_id(7), {}, [&](Result<SharedTile> tile) { answers += tile.has_value(); }); });
  }
  gate.count_down();
  EXPECT_TRUE(eventually([&] { return answers == 100; }));
  EXPECT_EQ(blobs->asked, 1);
  EXPECT_EQ(tiles->made, 1);
}

}  // namespace
}  // namespace farfield

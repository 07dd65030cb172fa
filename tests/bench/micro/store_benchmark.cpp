// SPDX-License-Identifier: Apache-2.0
// How many requests the store answers, and what a request costs that has to be made: the server's overhead per tile
// when casting costs nothing.
#include <benchmark/benchmark.h>

#include <atomic>
#include <random>
#include <vector>

#include "server/schedule/scheduled_cell_service.h"
#include "server/store/memory_tile_store.h"

namespace farfield {
namespace {

constexpr int kTiles = 50'000;  // about a gigabyte of real tiles: what a server keeps

TileKey key_of(int tile) {
  return {1,
          {.cell = {.level = 0, .x = tile / 144},
           .face = static_cast<std::uint8_t>(tile % 6),
           .x = static_cast<std::uint8_t>(tile % 144 / 6)}};
}

SharedTile small_tile() {
  auto tile = std::make_shared<EncodedTile>();
  tile->bytes = std::make_shared<const Bytes>(64);
  return tile;
}

MemoryTileStore& filled_store() {
  static MemoryTileStore* const store = [] {
    auto* filled = new MemoryTileStore(std::size_t{1} << 30);
    for (int t = 0; t < kTiles; ++t) filled->insert(key_of(t), small_tile());
    return filled;
  }();
  return *store;
}

std::vector<TileKey> random_keys(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<TileKey> keys;
  for (int i = 0; i < 4096; ++i) keys.push_back(key_of(static_cast<int>(random() % kTiles)));
  return keys;
}

void store_hit(benchmark::State& state) {
  MemoryTileStore& store = filled_store();
  const auto keys = random_keys(static_cast<unsigned>(state.thread_index()));
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(store.find(keys[i++ % keys.size()]));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(store_hit)->ThreadRange(1, 4)->UseRealTime();

void store_insert_and_evict(benchmark::State& state) {
  MemoryTileStore store(std::size_t{1} << 20);
  const SharedTile tile = small_tile();
  int t = 0;
  for (auto _ : state) store.insert(key_of(t++ % kTiles), tile);
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(store_insert_and_evict);

struct NoLeaves : LeafSource {
  Result<CellId> leaf_at(const glm::dvec3&, const CancelFlag&) override { return CellId{}; }
  Result<std::shared_ptr<const LeafPlan>> plan(const CellId&, const CancelFlag&) override {
    return std::make_shared<const LeafPlan>();
  }
  std::shared_ptr<const LeafPlan> fallback(const glm::dvec3&) override { return std::make_shared<const LeafPlan>(); }
};
struct FreeTiles : TileSource {
  Result<SharedTile> make(const TileId&, const CancelFlag&) override { return small_tile(); }
};
struct NoGeometry : GeometrySource {
  std::size_t chunk_count() const override { return 0; }
  std::size_t texture_count() const override { return 0; }
  PlacedSceneChunk placement(std::uint32_t) const override { return {}; }
  SceneTexture texture(std::uint32_t) const override { return {}; }
  SharedBytes chunk(std::uint32_t) const override { return nullptr; }
  SharedBytes texture_level(std::uint32_t, int) const override { return nullptr; }
};

// A leaf set's worth of tiles that are all made: queue, flight, worker and answer for each.
void service_makes_a_leaf_set(benchmark::State& state) {
  CellServiceParts parts;
  parts.geometry = std::make_shared<const NoGeometry>();
  parts.leaves = std::make_shared<NoLeaves>();
  parts.tiles = std::make_shared<FreeTiles>();
  parts.store = std::make_shared<MemoryTileStore>(0);
  parts.pool = std::make_shared<JobPool>(2);
  const auto service = make_cell_service(std::move(parts));
  constexpr int kSet = 500;
  for (auto _ : state) {
    // Shared, because the last answer may still be notifying when the waiting side has gone on.
    const auto left = std::make_shared<std::atomic<int>>(kSet);
    std::vector<Ticket> tickets;
    tickets.reserve(kSet);
    for (int t = 0; t < kSet; ++t) {
      tickets.push_back(
          service->tile(key_of(t).tile, {.view_share = 1.0f / static_cast<float>(t + 1)}, [left](Result<SharedTile>) {
            if (--*left == 0) left->notify_one();
          }));
    }
    for (int now = *left; now != 0; now = *left) left->wait(now);
  }
  state.SetItemsProcessed(state.iterations() * kSet);
}
BENCHMARK(service_makes_a_leaf_set)->UseRealTime();

}  // namespace
}  // namespace farfield

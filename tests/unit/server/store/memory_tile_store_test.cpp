// SPDX-License-Identifier: Apache-2.0
#include "server/store/memory_tile_store.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace farfield {
namespace {

SharedTile tile_of(std::size_t bytes) {
  auto tile = std::make_shared<EncodedTile>();
  tile->bytes = std::make_shared<const Bytes>(bytes);
  return tile;
}

TileKey key_of(std::int32_t x, ContentHash world = 1) {
  return {world, {.cell = {.level = 2, .x = x}}};
}

TEST(MemoryTileStore, ReturnsWhatWasKeptAndCounts) {
  MemoryTileStore store(1 << 20);
  EXPECT_EQ(store.find(key_of(1)), nullptr);
  const SharedTile tile = tile_of(1000);
  store.insert(key_of(1), tile);
  EXPECT_EQ(store.find(key_of(1)), tile);
  EXPECT_EQ(store.peek(key_of(1)), tile);
  const StoreStatistics statistics = store.statistics();
  EXPECT_EQ(statistics.hits, 1u);
  EXPECT_EQ(statistics.misses, 1u);
  EXPECT_EQ(statistics.inserts, 1u);
  EXPECT_EQ(statistics.items, 1u);
  EXPECT_GT(statistics.bytes, 1000 + sizeof(EncodedTile));
}

TEST(MemoryTileStore, TilesOfAnotherWorldAreOtherTiles) {
  MemoryTileStore store(1 << 20);
  store.insert(key_of(1, 1), tile_of(10));
  EXPECT_EQ(store.find(key_of(1, 2)), nullptr);
}

TEST(MemoryTileStore, ATileLargerThanTheStoreIsNotKept) {
  MemoryTileStore store(5000);
  store.insert(key_of(1), tile_of(100));
  store.insert(key_of(2), tile_of(6000));
  EXPECT_EQ(store.find(key_of(2)), nullptr);
  EXPECT_NE(store.find(key_of(1)), nullptr);
  EXPECT_EQ(store.statistics().rejected, 1u);
  EXPECT_EQ(store.statistics().evictions, 0u);
}

TEST(MemoryTileStore, EvictedTilesLiveOnWithWhoHoldsThem) {
  MemoryTileStore store(2500);
  store.insert(key_of(1), tile_of(1500));
  const SharedTile held = store.find(key_of(1));
  store.insert(key_of(2), tile_of(1500));
  EXPECT_EQ(store.peek(key_of(1)), nullptr);
  EXPECT_EQ(held->bytes->size(), 1500u);
}

TEST(MemoryTileStore, KeepsItsBoundUnderManyThreads) {
  static constexpr std::size_t kCapacity = 20'000;
  MemoryTileStore store(kCapacity);
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&store, t] {
      for (int i = 0; i < 3000; ++i) {
        const TileKey key = key_of((i * 7 + t * 13) % 40);
        if (!store.find(key)) store.insert(key, tile_of(static_cast<std::size_t>(i % 17) * 100));
        if (i % 64 == 0) {
          EXPECT_LE(store.statistics().bytes, kCapacity);
        }
      }
    });
  }
  threads.clear();
  const StoreStatistics statistics = store.statistics();
  EXPECT_LE(statistics.bytes, kCapacity);
  EXPECT_EQ(statistics.hits + statistics.misses, 4u * 3000u);
  EXPECT_GT(statistics.evictions, 0u);
}

}  // namespace
}  // namespace farfield

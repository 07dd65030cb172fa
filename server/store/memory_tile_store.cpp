// SPDX-License-Identifier: Apache-2.0
#include "server/store/memory_tile_store.h"

#include <utility>

namespace farfield {

std::size_t tile_memory_bytes(const EncodedTile& tile) {
  // A control block holds two counters and a virtual table pointer; each allocation has a header of two words.
  constexpr std::size_t kSharedPointerBytes = 4 * sizeof(void*);
  const std::size_t payload = tile.bytes ? sizeof(Bytes) + tile.bytes->capacity() + 2 * kSharedPointerBytes : 0;
  return sizeof(EncodedTile) + kSharedPointerBytes + payload;
}

MemoryTileStore::MemoryTileStore(std::size_t capacity_bytes) : tiles_(capacity_bytes) {}

SharedTile MemoryTileStore::find(const TileKey& key) {
  const std::scoped_lock lock(mutex_);
  const SharedTile* tile = tiles_.find(key);
  ++(tile ? hits_ : misses_);
  return tile ? *tile : nullptr;
}

SharedTile MemoryTileStore::peek(const TileKey& key) {
  const std::scoped_lock lock(mutex_);
  const SharedTile* tile = tiles_.peek(key);
  return tile ? *tile : nullptr;
}

void MemoryTileStore::insert(const TileKey& key, SharedTile tile) {
  const std::size_t bytes = tile_memory_bytes(*tile);
  const std::scoped_lock lock(mutex_);
  ++(tiles_.insert(key, std::move(tile), bytes) ? inserts_ : rejected_);
}

StoreStatistics MemoryTileStore::statistics() const {
  const std::scoped_lock lock(mutex_);
  return {.hits = hits_,
          .misses = misses_,
          .inserts = inserts_,
          .evictions = tiles_.evictions(),
          .rejected = rejected_,
          .items = tiles_.size(),
          .bytes = tiles_.bytes(),
          .capacity_bytes = tiles_.capacity_bytes()};
}

}  // namespace farfield

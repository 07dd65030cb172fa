// SPDX-License-Identifier: Apache-2.0
// The first tier: tiles in memory, bounded in bytes, least recently used out first.
#pragma once

#include <memory>
#include <mutex>

#include "server/store/byte_bounded_lru.h"
#include "server/store/tile_store.h"

namespace farfield {

/// What keeping one tile costs: its encoded bytes, its record, and the control blocks of both shared pointers.
std::size_t tile_memory_bytes(const EncodedTile& tile);

/// One mutex: a hit holds it for one hash look-up and one list splice, far less than a tile takes to send.
class MemoryTileStore final : public TileStore {
 public:
  /// A tile larger than the whole capacity is not kept; capacity 0 keeps nothing.
  explicit MemoryTileStore(std::size_t capacity_bytes);

  SharedTile find(const TileKey& key) override;
  SharedTile peek(const TileKey& key) override;
  void insert(const TileKey& key, SharedTile tile) override;
  StoreStatistics statistics() const override;

 private:
  mutable std::mutex mutex_;  // guards everything below
  ByteBoundedLru<TileKey, SharedTile> tiles_;
  std::uint64_t hits_ = 0, misses_ = 0, inserts_ = 0, rejected_ = 0;
};

}  // namespace farfield

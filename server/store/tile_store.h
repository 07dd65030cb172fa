// SPDX-License-Identifier: Apache-2.0
// Where encoded tiles are kept between being made and being asked for again: one interface for every tier, so that a
// faster tier can stand in front of a larger one.
//
// In: a key that names content (world and tile). Out: the shared immutable tile, or nothing. A store that cannot
// answer is a miss, never an error: whoever asked makes the tile again.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "common/impostor/tile_id.h"
#include "server/encode/tile_source.h"

namespace farfield {

/// Names one tile's content. `world` is the hash of everything its bytes depend on beside the id: the scene and the
/// impostor settings.
struct TileKey {
  ContentHash world = 0;
  TileId tile;

  auto operator<=>(const TileKey&) const = default;
};

using SharedTile = std::shared_ptr<const EncodedTile>;

struct StoreStatistics {
  std::uint64_t hits = 0, misses = 0;
  std::uint64_t inserts = 0;
  std::uint64_t evictions = 0;
  std::uint64_t rejected = 0;  // larger than the whole store
  std::size_t items = 0;
  std::size_t bytes = 0;  // overhead included
  std::size_t capacity_bytes = 0;
};

/// Thread-safe, every call from any thread.
class TileStore {
 public:
  virtual ~TileStore() = default;
  /// Returns: the tile, or null. Counts a hit or a miss and, on a hit, a use.
  virtual SharedTile find(const TileKey& key) = 0;
  /// The same, counting nothing: for a second look before making the tile.
  virtual SharedTile peek(const TileKey& key) = 0;
  /// Requires: `tile` and its bytes are not null. May forget other tiles, or not keep this one.
  virtual void insert(const TileKey& key, SharedTile tile) = 0;
  virtual StoreStatistics statistics() const = 0;
};

}  // namespace farfield

template <>
struct std::hash<farfield::TileKey> {
  std::size_t operator()(const farfield::TileKey& key) const {
    return std::hash<farfield::TileId>()(key.tile) ^ static_cast<std::size_t>(key.world);
  }
};

// SPDX-License-Identifier: Apache-2.0
// What the server made and may want again, as bytes under names: one interface for the tiers behind memory, which outlive the
// process. See blob_records.h for what the bytes say.
//
// A store that cannot answer is a miss, never an error: whoever asked makes it again. What is read was checked against a checksum.
#pragma once

#include <compare>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/impostor/tile_id.h"

namespace farfield {

/// Written to disk: never renumbered.
enum class BlobKind : std::uint8_t { kTile = 1, kPlan = 2, kLeafName = 3, kFallback = 4, kTransitions = 5 };

/// `world` is the hash of everything the bytes depend on beside kind and name: the scene, the settings and the version that made them.
/// A changed model has another world, so what was made of the old one is never found.
struct BlobKey {
  ContentHash world = 0;
  BlobKind kind = BlobKind::kTile;
  TileId name;  // of plans and leaf names only the cell counts

  auto operator<=>(const BlobKey&) const = default;
  /// 26 bytes, the same on every machine.
  std::string bytes() const;
};

struct BlobStoreStatistics {
  std::string_view tier = "disk";  // a literal
  bool is_reachable = true;        // false: everything is a miss until it is back
  std::uint64_t hits = 0, misses = 0;
  std::uint64_t damaged = 0;      // of the misses: found, and not what had been written
  std::uint64_t inserts = 0;      // written
  std::uint64_t dropped = 0;      // not written: too many were waiting, or writing failed
  std::uint64_t rewritten = 0;    // of the inserts: were there already, made elsewhere at the same time (Redis alone tells)
  std::uint64_t evictions = 0;
  std::uint64_t items = 0;
  std::uint64_t bytes = 0;           // what the tier occupies
  std::uint64_t capacity_bytes = 0;  // 0: bounded elsewhere
};

/// Thread-safe.
class BlobStore {
 public:
  virtual ~BlobStore() = default;
  /// May wait for a disk or a network: not for threads that serve sockets. Returns: null on a miss.
  virtual SharedBytes find(const BlobKey& key) = 0;
  /// Queues and returns at once; find() sees it from now on. Requires: not null.
  virtual void insert(const BlobKey& key, SharedBytes bytes) = 0;
  /// Waits until everything queued before is written. Errors: kIo if any of it could not be, since the last flush.
  virtual Status flush() = 0;
  virtual BlobStoreStatistics statistics() const = 0;
  /// Of each tier, the first asked first.
  virtual std::vector<BlobStoreStatistics> tiers() const { return {statistics()}; }
};

}  // namespace farfield

template <>
struct std::hash<farfield::BlobKey> {
  std::size_t operator()(const farfield::BlobKey& key) const {
    return std::hash<farfield::TileId>()(key.name) ^ static_cast<std::size_t>(key.world * 31 + static_cast<std::uint8_t>(key.kind));
  }
};

// SPDX-License-Identifier: Apache-2.0
// Leaf plans kept in memory, bounded in bytes, found by leaf or by any viewpoint in the leaf. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <mutex>

#include "common/cells/cell_id.h"
#include "server/cells/leaf_plan.h"
#include "server/store/byte_bounded_lru.h"

namespace farfield {

struct PlanCacheStatistics {
  std::uint64_t hits = 0, misses = 0, evictions = 0;
  std::size_t items = 0, bytes = 0, capacity_bytes = 0;
};

class PlanCache {
 public:
  PlanCache(std::size_t capacity_bytes, double finest_side_m);

  /// Leaves tile space, so the one kept cell that holds the viewpoint is its leaf. Costs a look-up per level.
  /// Returns: the plan for the viewpoint's enclosure, or null. Requires: finite.
  SharedPlan find(const glm::dvec3& viewpoint);
  /// The whole leaf's, by name, counting nothing: for a second look before making the plan.
  SharedPlan peek(const CellId& leaf);
  /// Requires: not null, of a whole leaf.
  void insert(SharedPlan plan);
  PlanCacheStatistics statistics() const;

 private:
  const CellGrid grid_;
  mutable std::mutex mutex_;  // guards everything below
  ByteBoundedLru<CellId, SharedPlan> plans_;
  std::uint64_t hits_ = 0, misses_ = 0;
};

/// Plans of fallback views by the finest cell they were asked for: cells around viewers overlap, so none is the one that holds a viewpoint.
/// Thread-safe.
class FallbackCache {
 public:
  explicit FallbackCache(std::size_t capacity_bytes) : plans_(capacity_bytes) {}

  /// Returns: null if it is not there.
  SharedPlan find(const CellId& finest);
  /// Requires: not null.
  void insert(const CellId& finest, SharedPlan plan);

 private:
  std::mutex mutex_;  // guards plans_
  ByteBoundedLru<CellId, SharedPlan> plans_;
};

}  // namespace farfield

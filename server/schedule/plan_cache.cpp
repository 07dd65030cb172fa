// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/plan_cache.h"

#include <utility>

namespace farfield {
namespace {

std::size_t plan_memory_bytes(const LeafPlan& plan) {
  std::size_t bytes = sizeof(LeafPlan) + plan.tiles.capacity() * sizeof(NeededTile) + plan.chunks.capacity() * sizeof(std::uint32_t) +
                      plan.enclosure.memory_bytes();
  for (const SharedPlan& part : plan.enclosures) bytes += plan_memory_bytes(*part);
  return bytes;
}

}  // namespace

PlanCache::PlanCache(std::size_t capacity_bytes, double finest_side_m) : grid_{finest_side_m}, plans_(capacity_bytes) {}

SharedPlan PlanCache::find(const glm::dvec3& viewpoint) {
  CellId cell = grid_.cell_at(viewpoint, 0);
  const std::scoped_lock lock(mutex_);
  for (;; cell = cell.parent()) {
    if (const SharedPlan* plan = plans_.find(cell)) {
      ++hits_;
      return plan_at(*plan, grid_, viewpoint);
    }
    if (cell.level >= kMaxCellLevel) break;
  }
  ++misses_;
  return nullptr;
}

SharedPlan PlanCache::peek(const CellId& leaf) {
  const std::scoped_lock lock(mutex_);
  const SharedPlan* plan = plans_.peek(leaf);
  return plan ? *plan : nullptr;
}

void PlanCache::insert(SharedPlan plan) {
  const std::size_t bytes = plan_memory_bytes(*plan);
  const CellId leaf = plan->leaf;
  const std::scoped_lock lock(mutex_);
  plans_.insert(leaf, std::move(plan), bytes);
}

PlanCacheStatistics PlanCache::statistics() const {
  const std::scoped_lock lock(mutex_);
  return {.hits = hits_,
          .misses = misses_,
          .evictions = plans_.evictions(),
          .items = plans_.size(),
          .bytes = plans_.bytes(),
          .capacity_bytes = plans_.capacity_bytes()};
}

SharedPlan FallbackCache::find(const CellId& finest) {
  const std::scoped_lock lock(mutex_);
  const SharedPlan* plan = plans_.find(finest);
  return plan ? *plan : nullptr;
}

void FallbackCache::insert(const CellId& finest, SharedPlan plan) {
  const std::size_t bytes = plan_memory_bytes(*plan);
  const std::scoped_lock lock(mutex_);
  plans_.insert(finest, std::move(plan), bytes);
}

}  // namespace farfield

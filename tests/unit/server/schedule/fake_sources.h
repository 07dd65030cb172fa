// SPDX-License-Identifier: Apache-2.0
// Sources of leaves, tiles and geometry for tests of the service: they count what they make, and hold it up where told to.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <latch>
#include <new>
#include <thread>

#include "server/schedule/scheduled_cell_service.h"

namespace farfield {

/// Within five seconds.
inline bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 5000 && !holds(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return holds();
}

// Leaves are the cells of level 1.
struct FakeLeaves : LeafSource {
  Result<CellId> leaf_at(const glm::dvec3& viewpoint, const CancelFlag&) override {
    ++searches;
    return grid.cell_at(viewpoint, 1);
  }
  Result<bool> can_stand_in(const CellId&, const CancelFlag&) override {
    ++stood;
    return !is_blocked;
  }
  Result<SharedPlan> plan(const CellId& leaf, const CancelFlag& cancel) override {
    ++plans;
    if (gate) gate->wait();
    while (is_blocking && !is_cancelled(cancel)) std::this_thread::yield();
    if (is_cancelled(cancel)) {
      ++cancelled;
      return fail(ErrorCode::kCancelled, "cancelled");
    }
    return std::make_shared<const LeafPlan>(LeafPlan{.leaf = leaf, .seconds = 0.25});
  }
  SharedPlan fallback(const glm::dvec3& viewpoint) override {
    ++fallbacks;
    return std::make_shared<const LeafPlan>(LeafPlan{.leaf = grid.cell_at(viewpoint, 2), .is_fallback = true});
  }
  CellGrid grid{1.0};
  std::atomic<int> fallbacks{0};
  std::latch* gate = nullptr;
  std::atomic<bool> is_blocking{false}, is_blocked{false};
  std::atomic<int> searches{0}, plans{0}, cancelled{0}, stood{0};
};

struct FakeTiles : TileSource {
  Result<SharedTile> make(const TileId& id, const CancelFlag& cancel) override {
    ++made;
    if (gate) gate->wait();
    if (id.face == 4) throw std::bad_alloc();
    if (id.face == 5) return fail(ErrorCode::kInternal, "the ray caster gave up");
    while (is_blocking && !is_cancelled(cancel)) std::this_thread::yield();
    if (is_cancelled(cancel)) {
      ++cancelled;
      return fail(ErrorCode::kCancelled, "cancelled");
    }
    auto tile = std::make_shared<EncodedTile>();
    tile->bytes = std::make_shared<const Bytes>(100 + id.x);
    tile->seconds = 0.01;
    tile->stages.intra = 0.002;
    return tile;
  }
  std::latch* gate = nullptr;
  std::atomic<bool> is_blocking{false};
  std::atomic<int> made{0}, cancelled{0};
};

struct FakeGeometry : GeometrySource {
  std::size_t chunk_count() const override { return 3; }
  std::size_t texture_count() const override { return 1; }
  PlacedSceneChunk placement(std::uint32_t chunk) const override { return {.hash = chunk}; }
  SceneTexture texture(std::uint32_t) const override { return {.level_count = 2}; }
  SharedBytes chunk(std::uint32_t chunk) const override { return std::make_shared<const Bytes>(chunk + 1); }
  SharedBytes texture_level(std::uint32_t, int level) const override {
    return std::make_shared<const Bytes>(10 + static_cast<std::size_t>(level));
  }
};

}  // namespace farfield

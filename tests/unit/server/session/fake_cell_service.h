// SPDX-License-Identifier: Apache-2.0
// A cell service whose world is arithmetic: every finest cell is a leaf with a few tiles, chunks and one texture.
// Answers at once, or when the test says so. Thread-safe.
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <set>

#include "server/schedule/cell_service.h"

namespace farfield::test {

struct FakeWorld {
  std::string name = "fake";
  int tiles = 6;               // per leaf; the last is empty
  std::size_t tile_bytes = 1000;
  int shared_tiles = 2;        // of these, the first are the same for all leaves (far shells)
  int texture_levels = 8;      // 128 texels: one level is finer than coarse
  bool is_blocked_ahead = false;  // nobody can stand in the leaves at x = 1 and beyond
  bool has_walls = false;      // across every leaf: what is beyond its middle along x is another enclosure
};

class FakeCellService final : public CellService {
 public:
  explicit FakeCellService(const FakeWorld& world = {}) : world_(world) {
    description_.name = world.name;
    description_.hash = hash_value(world.tile_bytes, 77) + static_cast<ContentHash>(world.name.size());
    description_.bounds = Box{glm::dvec3(-50), glm::dvec3(50)};
    description_.settings.finest_side_m = 2.0;
    description_.triangles = 12345;
  }

  // ── what the test decides and asks ──
  /// Answers to tiles wait until release_tiles().
  void hold_tiles() { set(holds_tiles_, true); }
  void release_tiles() {
    std::deque<std::function<void()>> held;
    {
      const std::lock_guard lock(mutex_);
      holds_tiles_ = false;
      held.swap(held_);
    }
    for (const auto& answer : held) answer();
  }
  /// Answers to questions about leaves wait for answer_leaf(), oldest first.
  void hold_leaves() { set(holds_leaves_, true); }
  bool answer_leaf() {
    std::unique_lock lock(mutex_);
    if (held_leaves_.empty()) return false;
    const auto first = held_leaves_.begin();
    const auto answer = std::move(first->second);
    held_leaves_.erase(first);
    lock.unlock();
    answer();
    return true;
  }
  std::size_t held_leaves() const { return get(held_leaves_).size(); }
  std::size_t held_tiles() const { return get(held_).size(); }
  int tile_requests() const { return get(tile_requests_); }
  int leaf_requests() const { return get(leaf_requests_); }
  int withdrawn() const { return get(withdrawn_); }
  int prefetch_requests() const { return get(prefetch_requests_); }
  /// The next this many tile requests fail.
  void fail_tiles(int count) { set(failures_, count); }

  CellGrid grid() const { return {description_.settings.finest_side_m}; }
  std::shared_ptr<const LeafPlan> plan_at(const glm::dvec3& viewpoint) const {
    auto plan = std::make_shared<LeafPlan>();
    plan->leaf = grid().cell_at(viewpoint, 0);
    plan->root = plan->leaf.ancestor(5);
    for (int i = 0; i < world_.tiles; ++i) {
      TileId id{plan->leaf, kIntraView, static_cast<std::uint8_t>(i % 6), static_cast<std::uint8_t>(i / 6), 0};
      if (i < world_.shared_tiles) id.cell = plan->root;
      plan->tiles.push_back({id, 1.0f / static_cast<float>(2 + i)});
    }
    plan->chunks = {0, 1};
    if (world_.has_walls) {
      const bool is_beyond = viewpoint.x > grid().box(plan->leaf).center().x;
      EnclosureMaskWriter half;
      half.divide();
      for (int child = 0; child < 8; ++child) half.fill((child & 1) == (is_beyond ? 1 : 0));
      plan->enclosure = EnclosureMask::from_bytes(half.take()).value();
      if (is_beyond) plan->tiles.resize(static_cast<std::size_t>(world_.shared_tiles));
    }
    return plan;
  }
  // Of the cell one level above the finest.
  std::shared_ptr<const LeafPlan> fallback_at(const glm::dvec3& viewpoint) const {
    auto plan = std::make_shared<LeafPlan>();
    plan->leaf = plan->root = grid().cell_at(viewpoint, 1);
    plan->is_fallback = true;
    plan->tiles.push_back({{plan->leaf, kFallbackView, 0, 0, 0}, 1.0f});
    plan->chunks = {0, 1};
    return plan;
  }

  // ── CellService ──
  const SceneDescription& scene() const override { return description_; }
  PlacedSceneChunk chunk_placement(std::uint32_t chunk) const override {
    PlacedSceneChunk placed;
    placed.hash = 1000 + chunk;
    placed.texture = chunk == 0 ? 0 : -1;
    placed.bounds = description_.bounds;
    if (chunk == 1) placed.scene_from_chunk[0][0] = 2;  // scaled: twelve numbers on the wire
    placed.scene_from_chunk[3] = glm::dvec3(3, 0, 0);
    return placed;
  }
  SceneTexture texture(std::uint32_t) const override {
    const int edge = 1 << (world_.texture_levels - 1);
    return {5000, edge, edge, world_.texture_levels};
  }

  Ticket leaf(const glm::dvec3& viewpoint, const WorkPriority& priority,
              Answer<std::shared_ptr<const LeafPlan>> answer) override {
    {
      const std::lock_guard lock(mutex_);
      ++leaf_requests_;
      prefetch_requests_ += priority.prefetch ? 1 : 0;
    }
    if (priority.prefetch && world_.is_blocked_ahead && grid().cell_at(viewpoint, 0).x >= 1) {
      answer(fail(ErrorCode::kNotFound, "nobody can stand there"));
      return Ticket();
    }
    std::unique_lock lock(mutex_);
    if (!holds_leaves_) {
      lock.unlock();
      answer(plan_at(viewpoint));
      return Ticket();
    }
    const int number = leaf_requests_;
    held_leaves_[number] = [answer, plan = plan_at(viewpoint)] { answer(plan); };
    return Ticket([this, number] {
      const std::lock_guard withdrawing(mutex_);
      held_leaves_.erase(number);
    });
  }
  Ticket fallback(const glm::dvec3& viewpoint, const WorkPriority&, Answer<std::shared_ptr<const LeafPlan>> answer) override {
    answer(fallback_at(viewpoint));
    return Ticket();
  }
  Ticket tile(const TileId& id, const WorkPriority&, Answer<std::shared_ptr<const EncodedTile>> answer) override {
    auto tile = std::make_shared<EncodedTile>();
    const bool is_empty = id.face == static_cast<std::uint8_t>((world_.tiles - 1) % 6) && id.view == kIntraView;
    tile->bytes = std::make_shared<const Bytes>(is_empty ? 0 : world_.tile_bytes, static_cast<std::uint8_t>(id.face));
    std::unique_lock lock(mutex_);
    ++tile_requests_;
    if (failures_ > 0) {
      --failures_;
      lock.unlock();
      answer(fail(ErrorCode::kUnavailable, "too busy"));
      return Ticket();
    }
    if (!holds_tiles_) {
      lock.unlock();
      answer(std::move(tile));
      return Ticket();
    }
    held_.push_back([answer, tile] { answer(tile); });
    return Ticket([this] {
      const std::lock_guard withdrawing(mutex_);
      ++withdrawn_;
    });
  }
  Ticket chunk(std::uint32_t chunk, const WorkPriority&, Answer<SharedBytes> answer) override {
    answer(std::make_shared<const Bytes>(300, static_cast<std::uint8_t>(chunk)));
    return Ticket();
  }
  Ticket texture_level(std::uint32_t, int level, const WorkPriority&, Answer<SharedBytes> answer) override {
    answer(std::make_shared<const Bytes>(100, static_cast<std::uint8_t>(level)));
    return Ticket();
  }

 private:
  template <class T>
  T get(const T& value) const {
    const std::lock_guard lock(mutex_);
    return value;
  }
  template <class T>
  void set(T& variable, T value) {
    const std::lock_guard lock(mutex_);
    variable = value;
  }

  FakeWorld world_;
  SceneDescription description_;
  mutable std::mutex mutex_;  // guards everything below
  bool holds_tiles_ = false, holds_leaves_ = false;
  int failures_ = 0;
  int tile_requests_ = 0, leaf_requests_ = 0, prefetch_requests_ = 0, withdrawn_ = 0;
  std::deque<std::function<void()>> held_;
  std::map<int, std::function<void()>> held_leaves_;  // by number of the request
};

}  // namespace farfield::test

// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/scheduled_cell_service.h"

#include <cmath>
#include <mutex>
#include <utility>

namespace farfield {
namespace {

// A leaf request waits twice: for the name of its leaf, then for the leaf's plan.
struct LeafName {
  CellId leaf;
  bool is_blocked = false;  // nobody can stand in it; found out only for those who are expected there
};
struct LeafRequest {
  using NameFlight = SingleFlight<CellId, LeafName, JobQueue>;
  using PlanFlight = SingleFlight<CellId, SharedPlan, JobQueue>;

  std::mutex mutex;  // guards everything below
  bool is_released = false;
  CellId leaf;
  PlanFlight::Handle plan;
};

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// The same job as `priority`, `elapsed_s` later.
WorkPriority later(WorkPriority priority, double elapsed_s) {
  priority.seconds_until_needed -= elapsed_s;
  return priority;
}

class ScheduledCellService final : public MeasuredCellService {
 public:
  explicit ScheduledCellService(CellServiceParts parts)
      : parts_(std::move(parts)),
        grid_{parts_.scene.settings.finest_side_m},
        plan_cache_(parts_.plan_cache_bytes, parts_.scene.settings.finest_side_m),
        plans_(parts_.pool->queue()),
        leaf_names_(parts_.pool->queue()),
        fallbacks_(parts_.pool->queue()),
        tiles_(parts_.pool->queue()),
        geometry_(parts_.pool->queue()) {}

  const SceneDescription& scene() const override { return parts_.scene; }
  PlacedSceneChunk chunk_placement(std::uint32_t chunk) const override { return parts_.geometry->placement(chunk); }
  SceneTexture texture(std::uint32_t texture) const override { return parts_.geometry->texture(texture); }

  Ticket leaf(const glm::dvec3& viewpoint, const WorkPriority& priority, Answer<SharedPlan> answer) override {
    if (!is_finite(viewpoint)) {
      answer(fail(ErrorCode::kInvalidArgument, "a leaf was asked for at a viewpoint that is not a finite position"));
      return {};
    }
    if (SharedPlan plan = plan_cache_.find(viewpoint)) {
      answer(std::move(plan));
      return {};
    }
    // Every leaf is a union of finest cells, so viewpoints in one finest cell share the search for their leaf.
    const CellId finest = grid_.cell_at(viewpoint, 0);
    const auto request = std::make_shared<LeafRequest>();
    auto at_viewpoint = [this, viewpoint, answer = std::move(answer)](Result<SharedPlan> whole) {
      if (whole) *whole = plan_at(*whole, grid_, viewpoint);
      answer(std::move(whole));
    };
    auto named = [this, request, priority, asked_s = clock_(), answer = std::move(at_viewpoint)](Result<LeafName> name) {
      if (!name) {
        answer(tl::unexpected<Error>(std::move(name.error())));
      } else if (priority.prefetch && name->is_blocked) {
        answer(fail(ErrorCode::kNotFound, "nobody can stand in the leaf ahead"));
      } else {
        plan(name->leaf, request, later(priority, clock_() - asked_s), answer);
      }
    };
    const auto name = leaf_names_.join(
        finest, priority,
        [this, viewpoint, is_ahead = priority.prefetch](const CancelFlag& cancel) { return name_leaf(viewpoint, is_ahead, cancel); },
        std::move(named));
    return Ticket([this, finest, name, request] {
      leaf_names_.withdraw(finest, name);
      std::unique_lock lock(request->mutex);
      request->is_released = true;
      const auto waiting = std::exchange(request->plan, nullptr);
      lock.unlock();
      plans_.withdraw(request->leaf, waiting);
    });
  }

  Ticket fallback(const glm::dvec3& viewpoint, const WorkPriority& priority, Answer<SharedPlan> answer) override {
    if (!is_finite(viewpoint)) {
      answer(fail(ErrorCode::kInvalidArgument, "a fallback view was asked for at a viewpoint that is not a finite position"));
      return {};
    }
    const CellId finest = grid_.cell_at(viewpoint, 0);
    const auto waiter = fallbacks_.join(
        finest, priority,
        [this, middle = grid_.box(finest).center()](const CancelFlag&) -> Result<SharedPlan> {
          SharedPlan plan = parts_.leaves->fallback(middle);
          place_chunks(*plan);
          return plan;
        },
        std::move(answer));
    return Ticket([this, finest, waiter] { fallbacks_.withdraw(finest, waiter); });
  }

  Ticket tile(const TileId& id, const WorkPriority& priority, Answer<SharedTile> answer) override {
    const TileKey key{parts_.scene.hash, id};
    if (SharedTile tile = parts_.store->find(key)) {
      answer(std::move(tile));
      return {};
    }
    const auto waiter = tiles_.join(
        id, priority, [this, key](const CancelFlag& cancel) { return make_tile(key, cancel); }, std::move(answer));
    return Ticket([this, id, waiter] { tiles_.withdraw(id, waiter); });
  }

  Ticket chunk(std::uint32_t chunk, const WorkPriority& priority, Answer<SharedBytes> answer) override {
    if (chunk >= parts_.geometry->chunk_count()) {
      answer(fail(ErrorCode::kNotFound, "chunk {} was asked for, the scene has {}", chunk,
                  parts_.geometry->chunk_count()));
      return {};
    }
    return geometry(
        chunk, priority, [this, chunk] { return parts_.geometry->chunk(chunk); }, std::move(answer));
  }

  Ticket texture_level(std::uint32_t texture, int level, const WorkPriority& priority,
                       Answer<SharedBytes> answer) override {
    if (texture >= parts_.geometry->texture_count() || level < 0 ||
        level >= parts_.geometry->texture(texture).level_count) {
      answer(fail(ErrorCode::kNotFound, "level {} of texture {} was asked for and does not exist", level, texture));
      return {};
    }
    const std::uint64_t key = kTextureKeys | (static_cast<std::uint64_t>(level) << 32) | texture;
    return geometry(
        key, priority, [this, texture, level] { return parts_.geometry->texture_level(texture, level); },
        std::move(answer));
  }

  CellServiceStatistics statistics() const override {
    return {.queue = parts_.pool->queue_statistics(),
            .pool = parts_.pool->pool_statistics(),
            .store = parts_.store->statistics(),
            .plan_cache = plan_cache_.statistics(),
            .leaf_flights = leaf_names_.statistics(),
            .plan_flights = plans_.statistics(),
            .tile_flights = tiles_.statistics(),
            .geometry_flights = geometry_.statistics(),
            .tile_seconds = recorder_.tile_seconds(),
            .skipped = parts_.tiles->skips(),
            .left_out = parts_.leaves->skips(),
            .certificates = parts_.tiles->certificates()};
  }
  std::vector<CellStatistics> cell_statistics() const override { return recorder_.cells(); }

 private:
  Result<LeafName> name_leaf(const glm::dvec3& viewpoint, bool is_ahead, const CancelFlag& cancel) {
    const Result<CellId> leaf = parts_.leaves->leaf_at(viewpoint, cancel);
    if (!leaf) return tl::unexpected(leaf.error());
    if (!is_ahead || plan_cache_.peek(*leaf)) return LeafName{*leaf};
    const Result<bool> can_stand = parts_.leaves->can_stand_in(*leaf, cancel);
    if (!can_stand) return tl::unexpected(can_stand.error());
    return LeafName{*leaf, !*can_stand};
  }

  static constexpr std::uint64_t kTextureKeys = std::uint64_t{1} << 63;  // chunks are keyed by their index alone

  // The second half of a leaf request: no ticket of its own, the request's withdraws it.
  void plan(const CellId& leaf, const std::shared_ptr<LeafRequest>& request, const WorkPriority& priority,
            const Answer<SharedPlan>& answer) {
    if (SharedPlan known = plan_cache_.peek(leaf)) {
      answer(std::move(known));
      return;
    }
    const auto waiter = plans_.join(
        leaf, priority, [this, leaf](const CancelFlag& cancel) { return make_plan(leaf, cancel); }, answer);
    {
      const std::scoped_lock lock(request->mutex);
      request->leaf = leaf;
      if (!request->is_released) {
        request->plan = waiter;
        return;
      }
    }
    plans_.withdraw(leaf, waiter);  // released between the two halves
  }

  // What is only cheap after its first call is called here once, not on the session's thread.
  void place_chunks(const LeafPlan& plan) const {
    for (const std::uint32_t chunk : plan.chunks) parts_.geometry->placement(chunk);
  }

  Result<SharedPlan> make_plan(const CellId& leaf, const CancelFlag& cancel) {
    // Finished between the first look and the start of this flight?
    if (SharedPlan known = plan_cache_.peek(leaf)) return known;
    Result<SharedPlan> made = parts_.leaves->plan(leaf, cancel);
    if (!made) return made;
    if (!*made) return fail(ErrorCode::kInternal, "the leaf source returned no plan and no error");
    place_chunks(**made);
    plan_cache_.insert(*made);
    recorder_.add_plan(**made);
    return made;
  }

  Result<SharedTile> make_tile(const TileKey& key, const CancelFlag& cancel) {
    if (SharedTile known = parts_.store->peek(key)) return known;
    Result<SharedTile> made = parts_.tiles->make(key.tile, cancel);
    if (!made) return made;
    if (!*made || !(*made)->bytes) {
      return fail(ErrorCode::kInternal, "the tile source returned no tile and no error");
    }
    parts_.store->insert(key, *made);
    recorder_.add_tile(key.tile, **made);
    return made;
  }

  template <class MakeBytes>
  Ticket geometry(std::uint64_t key, const WorkPriority& priority, MakeBytes make, Answer<SharedBytes> answer) {
    const auto waiter = geometry_.join(
        key, priority, [make](const CancelFlag&) -> Result<SharedBytes> { return make(); }, std::move(answer));
    return Ticket([this, key, waiter] { geometry_.withdraw(key, waiter); });
  }

  const CellServiceParts parts_;
  const SecondsClock clock_ = steady_clock_seconds();
  const CellGrid grid_;
  PlanCache plan_cache_;
  CellStatisticsRecorder recorder_;
  // Destroyed in the opposite order: names first, because their answers join plans.
  LeafRequest::PlanFlight plans_;
  LeafRequest::NameFlight leaf_names_;
  LeafRequest::PlanFlight fallbacks_;  // by the finest cell of the viewpoint
  SingleFlight<TileId, SharedTile, JobQueue> tiles_;
  SingleFlight<std::uint64_t, SharedBytes, JobQueue> geometry_;
};

}  // namespace

std::unique_ptr<MeasuredCellService> make_cell_service(CellServiceParts parts) {
  return std::make_unique<ScheduledCellService>(std::move(parts));
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/scheduled_cell_service.h"

#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "server/schedule/lease_waits.h"
#include "server/schedule/request_chain.h"
#include "server/store/blob_records.h"

namespace farfield {
namespace {

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
        world_(world_of(parts_.scene)),
        grid_{parts_.scene.settings.finest_side_m},
        plan_cache_(parts_.plan_cache_bytes, parts_.scene.settings.finest_side_m),
        fallback_cache_(parts_.plan_cache_bytes / 4),
        plans_(parts_.pool->queue()),
        leaf_names_(parts_.pool->queue()),
        fallbacks_(prompt_queue()),
        tiles_(parts_.pool->queue()),
        geometry_(prompt_queue()) {
    if (!parts_.blobs) return;
    fetched_leaves_.emplace(prompt_queue());
    fetched_tiles_.emplace(prompt_queue());
    if (const SharedBytes learned = parts_.blobs->find(blob_key(BlobKind::kTransitions, {}))) {
      static_cast<void>(transitions_.read(*learned));  // another version's: learned again
    }
    if (parts_.lease) lease_waits_.emplace(parts_.lease);
  }
  ~ScheduledCellService() override {
    if (lease_waits_) lease_waits_->stop();  // what waits there would join the flights again
    if (transitions_.noted() > 0) keep(BlobKind::kTransitions, {}, transitions_.write());
  }

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
    const auto chain = std::make_shared<RequestChain>();
    // Every leaf is a union of finest cells, so viewpoints in one finest cell share the search for their leaf.
    const CellId finest = grid_.cell_at(viewpoint, 0);
    auto at_viewpoint = [this, viewpoint, answer = std::move(answer)](Result<SharedPlan> whole) {
      if (whole) *whole = plan_at(*whole, grid_, viewpoint);
      answer(std::move(whole));
    };
    LeafRequest request{viewpoint, finest, priority, clock_(), {}, std::move(at_viewpoint)};
    if (fetched_leaves_) fetch_leaf(chain, std::move(request)); else name_leaf(chain, std::move(request));
    return chain->ticket();
  }

  Ticket fallback(const glm::dvec3& viewpoint, const WorkPriority& priority, Answer<SharedPlan> answer) override {
    if (!is_finite(viewpoint)) {
      answer(fail(ErrorCode::kInvalidArgument, "a fallback view was asked for at a viewpoint that is not a finite position"));
      return {};
    }
    const CellId finest = grid_.cell_at(viewpoint, 0);
    if (SharedPlan known = fallback_cache_.find(finest)) {
      answer(std::move(known));
      return {};
    }
    const auto waiter = fallbacks_.join(
        finest, priority, [this, finest](const CancelFlag&) -> Result<SharedPlan> { return make_fallback(finest); }, std::move(answer));
    return Ticket([this, finest, waiter] { fallbacks_.withdraw(finest, waiter); });
  }

  void note_transition(const std::optional<CellId>& previous, const CellId& current, const CellId& next, const glm::dvec3& entry) override {
    transitions_.note(previous, current, next, entry);
    // A server that is killed forgets no more than the last of these.
    if (parts_.blobs && transitions_.noted() % kNotedBetweenWrites == 0) keep(BlobKind::kTransitions, {}, transitions_.write());
  }
  Departures departures(const std::optional<CellId>& previous, const CellId& current) const override { return transitions_.from(previous, current); }

  Ticket tile(const TileId& id, const WorkPriority& priority, Answer<SharedTile> answer) override {
    const TileKey key{parts_.scene.hash, id};
    if (SharedTile tile = parts_.store->find(key)) {
      answer(std::move(tile));
      return {};
    }
    const auto chain = std::make_shared<RequestChain>();
    TileRequest request{key, priority, clock_(), {}, std::move(answer)};
    if (fetched_tiles_) fetch_tile(chain, std::move(request)); else make_tile(chain, std::move(request));
    return chain->ticket();
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
            .blobs = parts_.blobs ? parts_.blobs->tiers() : std::vector<BlobStoreStatistics>{},
            .plan_cache = plan_cache_.statistics(),
            .leaf_flights = leaf_names_.statistics(),
            .plan_flights = plans_.statistics(),
            .tile_flights = tiles_.statistics(),
            .geometry_flights = geometry_.statistics(),
            .tile_seconds = recorder_.tile_seconds(),
            .plans_made = recorder_.plans(),
            .turns = {.leases = turns_.leases, .alone = turns_.alone, .waits = turns_.waits, .waits_in_vain = turns_.waits_in_vain},
            .skipped = parts_.tiles->skips(),
            .left_out = parts_.leaves->skips(),
            .certificates = parts_.tiles->certificates()};
  }
  std::vector<CellStatistics> cell_statistics() const override { return recorder_.cells(); }

 private:
  JobQueue& prompt_queue() const { return (parts_.prompt_pool ? parts_.prompt_pool : parts_.pool)->queue(); }

  // How long a request still waits for another server.
  struct Patience {
    std::optional<LeaseWaits::Clock::time_point> until;  // none: has not waited yet
    bool has_waited() const { return until.has_value(); }
    bool is_over() const { return until && LeaseWaits::Clock::now() >= *until; }
  };
  struct LeafRequest {
    glm::dvec3 viewpoint;
    CellId finest;  // that holds it
    WorkPriority priority;
    double asked_s = 0;
    Patience patience;
    Answer<SharedPlan> answer;
  };
  struct TileRequest {
    TileKey key;
    WorkPriority priority;
    double asked_s = 0;
    Patience patience;
    Answer<SharedTile> answer;
  };
  // What the tiers behind memory know of a finest cell.
  struct FetchedLeaf {
    std::optional<LeafName> name;
    SharedPlan plan;
  };
  static ContentHash world_of(const SceneDescription& scene) {
    const std::array<ContentHash, 2> parts{scene.hash, kImpostorVersion};
    return hash_values(std::span<const ContentHash>(parts));
  }
  BlobKey blob_key(BlobKind kind, const TileId& name) const { return {world_, kind, name}; }
  // What this version cannot read is missing, as what was never written is.
  template <class Read>
  auto fetched(BlobKind kind, const TileId& name, Read read) {
    const SharedBytes bytes = parts_.blobs->find(blob_key(kind, name));
    decltype(read(*bytes)) record = tl::unexpected<Error>(Error{ErrorCode::kNotFound, "not stored"});
    if (bytes) record = read(*bytes);
    return record;
  }
  void keep(BlobKind kind, const TileId& name, Bytes record) {
    if (parts_.blobs) parts_.blobs->insert(blob_key(kind, name), std::make_shared<const Bytes>(std::move(record)));
  }

  // ── leaves: stored, else named, then planned ──
  void fetch_leaf(const std::shared_ptr<RequestChain>& chain, LeafRequest request) {
    chain->wait([&] {
      const CellId finest = request.finest;
      const WorkPriority priority = request.priority;
      auto handle = fetched_leaves_->join(
          finest, priority, [this, finest](const CancelFlag&) { return find_leaf(finest); },
          [this, chain, request = std::move(request)](Result<FetchedLeaf> found) mutable { use_fetched(chain, std::move(request), std::move(found)); });
      return [this, finest, handle = std::move(handle)] { fetched_leaves_->withdraw(finest, handle); };
    });
  }

  Result<FetchedLeaf> find_leaf(const CellId& finest) {
    FetchedLeaf found;
    const Result<LeafName> name = fetched(BlobKind::kLeafName, {.cell = finest}, read_leaf_name_record);
    if (!name || !finest.is_within(name->leaf)) return found;
    found.name = *name;
    found.plan = plan_cache_.peek(name->leaf);
    if (!found.plan && !name->is_blocked) found.plan = find_plan(name->leaf);
    return found;
  }

  // Returns: null if it is not stored.
  SharedPlan find_plan(const CellId& leaf) {
    const auto read = [this](ByteView bytes) { return read_plan_record(bytes, parts_.geometry->chunk_count()); };
    const Result<SharedPlan> plan = fetched(BlobKind::kPlan, {.cell = leaf}, read);
    if (!plan || (*plan)->leaf != leaf) return nullptr;
    place_chunks(**plan);
    plan_cache_.insert(*plan);
    return *plan;
  }

  void use_fetched(const std::shared_ptr<RequestChain>& chain, LeafRequest request, Result<FetchedLeaf> found) {
    if (found && found->plan) {
      request.answer(std::move(found->plan));
    } else if (found && found->name) {
      use_name(chain, std::move(request), *found->name);
    } else {
      name_leaf(chain, std::move(request));
    }
  }

  void name_leaf(const std::shared_ptr<RequestChain>& chain, LeafRequest request) {
    chain->wait([&] {
      const CellId finest = request.finest;
      const WorkPriority priority = later(request.priority, clock_() - request.asked_s);
      auto handle = leaf_names_.join(
          finest, priority,
          [this, finest, viewpoint = request.viewpoint, is_ahead = priority.prefetch](const CancelFlag& cancel) { return find_name(finest, viewpoint, is_ahead, cancel); },
          [this, chain, request = std::move(request)](Result<LeafName> name) mutable {
            if (name) use_name(chain, std::move(request), *name); else request.answer(tl::unexpected<Error>(std::move(name.error())));
          });
      return [this, finest, handle = std::move(handle)] { leaf_names_.withdraw(finest, handle); };
    });
  }

  Result<LeafName> find_name(const CellId& finest, const glm::dvec3& viewpoint, bool is_ahead, const CancelFlag& cancel) {
    const Result<CellId> leaf = parts_.leaves->leaf_at(viewpoint, cancel);
    if (!leaf) return tl::unexpected(leaf.error());
    LeafName name{*leaf};
    if (is_ahead && !plan_cache_.peek(*leaf)) {
      const Result<bool> can_stand = parts_.leaves->can_stand_in(*leaf, cancel);
      if (!can_stand) return tl::unexpected(can_stand.error());
      name.is_blocked = !*can_stand;
    }
    keep(BlobKind::kLeafName, {.cell = finest}, write_leaf_name_record(name));
    return name;
  }

  void use_name(const std::shared_ptr<RequestChain>& chain, LeafRequest request, const LeafName& name) {
    if (request.priority.prefetch && name.is_blocked) {
      request.answer(fail(ErrorCode::kNotFound, "nobody can stand in the leaf ahead"));
    } else if (SharedPlan known = plan_cache_.peek(name.leaf)) {
      request.answer(std::move(known));
    } else {
      chain->wait([&] {
        const WorkPriority priority = later(request.priority, clock_() - request.asked_s);
        const bool insists = note_making(request.patience);
        auto handle = plans_.join(
            name.leaf, priority, [this, leaf = name.leaf, insists](const CancelFlag& cancel) { return make_plan(leaf, insists, cancel); },
            [this, chain, leaf = name.leaf, request = std::move(request)](Result<SharedPlan> plan) mutable {
              if (!plan || *plan) return request.answer(std::move(plan));
              wait_for_other(chain, blob_key(BlobKind::kPlan, {.cell = leaf}), std::move(request), &ScheduledCellService::fetch_leaf);
            });
        return [this, leaf = name.leaf, handle = std::move(handle)] { plans_.withdraw(leaf, handle); };
      });
    }
  }

  SharedPlan make_fallback(const CellId& finest) {
    SharedPlan plan;
    if (parts_.blobs) {
      const auto read = [this](ByteView bytes) { return read_plan_record(bytes, parts_.geometry->chunk_count()); };
      if (Result<SharedPlan> stored = fetched(BlobKind::kFallback, {.cell = finest}, read); stored && (*stored)->is_fallback) plan = std::move(*stored);
    }
    if (!plan) {
      plan = parts_.leaves->fallback(grid_.box(finest).center());
      keep(BlobKind::kFallback, {.cell = finest}, write_plan_record(*plan));
    }
    place_chunks(*plan);
    fallback_cache_.insert(finest, plan);
    return plan;
  }

  // ── tiles: stored, else made ──
  void fetch_tile(const std::shared_ptr<RequestChain>& chain, TileRequest request) {
    chain->wait([&] {
      const TileKey key = request.key;
      const WorkPriority priority = later(request.priority, clock_() - request.asked_s);
      auto handle = fetched_tiles_->join(
          key.tile, priority, [this, key](const CancelFlag&) { return find_tile(key); },
          [this, chain, request = std::move(request)](Result<SharedTile> found) mutable {
            if (found && *found) request.answer(std::move(found)); else make_tile(chain, std::move(request));
          });
      return [this, tile = key.tile, handle = std::move(handle)] { fetched_tiles_->withdraw(tile, handle); };
    });
  }

  // Returns: null if it is not stored.
  Result<SharedTile> find_tile(const TileKey& key) {
    if (SharedTile known = parts_.store->peek(key)) return known;
    const Result<SharedTile> tile = fetched(BlobKind::kTile, key.tile, read_tile_record);
    if (!tile) return SharedTile();
    parts_.store->insert(key, *tile);
    return *tile;
  }

  void make_tile(const std::shared_ptr<RequestChain>& chain, TileRequest request) {
    chain->wait([&] {
      const TileKey key = request.key;
      const WorkPriority priority = later(request.priority, clock_() - request.asked_s);
      const bool insists = note_making(request.patience);
      auto handle = tiles_.join(
          key.tile, priority, [this, key, insists](const CancelFlag& cancel) { return make_tile(key, insists, cancel); },
          [this, chain, request = std::move(request)](Result<SharedTile> tile) mutable {
            if (!tile || *tile) return request.answer(std::move(tile));
            const BlobKey blob = blob_key(BlobKind::kTile, request.key.tile);
            wait_for_other(chain, blob, std::move(request), &ScheduledCellService::fetch_tile);
          });
      return [this, tile = key.tile, handle = std::move(handle)] { tiles_.withdraw(tile, handle); };
    });
  }

  // ── turns among servers: what another makes is waited for, then looked for again ──
  template <class Request>
  void wait_for_other(const std::shared_ptr<RequestChain>& chain, const BlobKey& key, Request request,
                      void (ScheduledCellService::*fetch)(const std::shared_ptr<RequestChain>&, Request)) {
    if (!request.patience.has_waited()) request.patience.until = LeaseWaits::Clock::now() + kPatience;
    ++turns_.waits;
    chain->wait([&] {
      const auto until = *request.patience.until;
      // Shared: functions are copied, and answers need not be copyable twice.
      const auto kept = std::make_shared<Request>(std::move(request));
      auto handle = lease_waits_->wait(key, until, [this, chain, kept, fetch] { (this->*fetch)(chain, std::move(*kept)); });
      return [this, handle = std::move(handle)] { lease_waits_->withdraw(handle); };
    });
  }
  // Returns: whether it is to be made whoever else makes it.
  bool note_making(const Patience& patience) {
    if (patience.has_waited()) ++turns_.waits_in_vain;
    return patience.is_over();
  }
  // Requires: a casting thread, about to make it.
  HeldTurn take_turn(const BlobKey& key, bool insists) {
    return parts_.lease && parts_.blobs && !insists ? HeldTurn(*parts_.lease, key) : HeldTurn(Turn::kAlone);
  }
  void count_turn(Turn turn) {
    if (parts_.lease) ++(turn == Turn::kOurs ? turns_.leases : turns_.alone);
  }

  static constexpr std::uint64_t kTextureKeys = std::uint64_t{1} << 63;  // chunks are keyed by their index alone

  // What is only cheap after its first call is called here once, not on the session's thread.
  void place_chunks(const LeafPlan& plan) const {
    for (const std::uint32_t chunk : plan.chunks) parts_.geometry->placement(chunk);
  }

  // Returns: null if another server makes it.
  Result<SharedPlan> make_plan(const CellId& leaf, bool insists, const CancelFlag& cancel) {
    // Finished between the first look and the start of this flight?
    if (SharedPlan known = plan_cache_.peek(leaf)) return known;
    const HeldTurn turn = take_turn(blob_key(BlobKind::kPlan, {.cell = leaf}), insists);
    if (turn.turn() == Turn::kTheirs) return SharedPlan();
    // Plans are kept by leaf, and looked for by finest cell: a leaf may be stored and none of its cells that was asked for so far.
    if (parts_.blobs) {
      if (SharedPlan found = find_plan(leaf)) return found;
    }
    Result<SharedPlan> made = parts_.leaves->plan(leaf, cancel);
    if (!made) return made;
    if (!*made) return fail(ErrorCode::kInternal, "the leaf source returned no plan and no error");
    place_chunks(**made);
    plan_cache_.insert(*made);
    keep(BlobKind::kPlan, {.cell = leaf}, write_plan_record(**made));
    count_turn(turn.turn());
    recorder_.add_plan(**made);
    return made;
  }

  // Returns: null if another server makes it.
  Result<SharedTile> make_tile(const TileKey& key, bool insists, const CancelFlag& cancel) {
    if (SharedTile known = parts_.store->peek(key)) return known;
    const HeldTurn turn = take_turn(blob_key(BlobKind::kTile, key.tile), insists);
    if (turn.turn() == Turn::kTheirs) return SharedTile();
    if (turn.turn() == Turn::kMade) {
      if (Result<SharedTile> found = find_tile(key); found && *found) return found;
    }
    Result<SharedTile> made = parts_.tiles->make(key.tile, cancel);
    if (!made) return made;
    if (!*made || !(*made)->bytes) {
      return fail(ErrorCode::kInternal, "the tile source returned no tile and no error");
    }
    parts_.store->insert(key, *made);
    keep(BlobKind::kTile, key.tile, write_tile_record(**made));
    count_turn(turn.turn());
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
  const ContentHash world_;  // of the blobs
  // How long another server may take before what it makes is made here too: it lives, or its lease would be gone.
  static constexpr std::chrono::seconds kPatience{15};
  const CellGrid grid_;
  PlanCache plan_cache_;
  FallbackCache fallback_cache_;
  static constexpr std::uint64_t kNotedBetweenWrites = 2048;
  TransitionTable transitions_;
  CellStatisticsRecorder recorder_;
  struct {
    std::atomic<std::uint64_t> leases{0}, alone{0}, waits{0}, waits_in_vain{0};
  } turns_;
  std::optional<LeaseWaits> lease_waits_;  // none without a lease
  // Destroyed in the opposite order: the answers of those below join those above.
  SingleFlight<CellId, SharedPlan, JobQueue> plans_;
  SingleFlight<CellId, LeafName, JobQueue> leaf_names_;
  SingleFlight<CellId, SharedPlan, JobQueue> fallbacks_;  // by the finest cell of the viewpoint
  SingleFlight<TileId, SharedTile, JobQueue> tiles_;
  SingleFlight<std::uint64_t, SharedBytes, JobQueue> geometry_;
  std::optional<SingleFlight<CellId, FetchedLeaf, JobQueue>> fetched_leaves_;  // by finest cell; none without blobs
  std::optional<SingleFlight<TileId, SharedTile, JobQueue>> fetched_tiles_;
};

}  // namespace

std::unique_ptr<MeasuredCellService> make_cell_service(CellServiceParts parts) {
  return std::make_unique<ScheduledCellService>(std::move(parts));
}

}  // namespace farfield

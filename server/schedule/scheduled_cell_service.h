// SPDX-License-Identifier: Apache-2.0
// The cell service of one scene: the store in front, single flight behind it, the shared queue and pool for the work.
//
//   request ─▶ plan cache / tile store ─▶ blobs (disk, network) ─▶ single flight ─▶ job queue ─▶ worker: source makes it
//                                                                                   ─▶ store, blobs ─▶ answers
//
// Servers that share blobs take turns (generation_lease.h): what another makes is waited for and then fetched.
//
// Owns nothing of the scene but shares in it. Destroying the service drops all outstanding answers, cancels its work
// and waits for what runs.
#pragma once

#include <memory>
#include <vector>

#include "server/schedule/cell_service.h"
#include "server/schedule/cell_statistics.h"
#include "server/schedule/geometry_source.h"
#include "server/schedule/plan_cache.h"
#include "server/schedule/worker_pool.h"
#include "server/store/blob_store.h"
#include "server/store/generation_lease.h"
#include "server/store/single_flight.h"
#include "server/store/tile_store.h"

namespace farfield {

/// Everything a service needs; none may be null but where it says so.
struct CellServiceParts {
  SceneDescription scene;                          // its hash names the world in the store
  std::shared_ptr<const GeometrySource> geometry;  // scene_geometry(scene)
  std::shared_ptr<LeafSource> leaves;
  std::shared_ptr<TileSource> tiles;
  std::shared_ptr<TileStore> store;  // may be shared by the services of several scenes
  std::shared_ptr<JobPool> pool;     // likewise; casts
  std::shared_ptr<BlobStore> blobs;  // likewise; null: nothing outlives the process
  std::shared_ptr<GenerationLease> lease;  // likewise; with others that share the blobs; null: nobody does
  /// Likewise; for what takes no casting: blobs, fallback plans, near geometry. Null: the casting pool does that as well.
  std::shared_ptr<JobPool> prompt_pool;
  std::size_t plan_cache_bytes = std::size_t{64} << 20;
};

/// Tiles and plans that were made while other servers might have made them; all zero without a lease.
struct TurnStatistics {
  std::uint64_t leases = 0;         // made holding a lease
  std::uint64_t alone = 0;          // made without: nobody could tell, or another server took too long
  std::uint64_t waits = 0;          // of requests, for what another server made
  std::uint64_t waits_in_vain = 0;  // of these, ended by making it here
};

struct CellServiceStatistics {
  QueueStatistics queue;  // of the pool, all scenes together
  PoolStatistics pool;
  StoreStatistics store;                   // all scenes together
  std::vector<BlobStoreStatistics> blobs;  // likewise, tier by tier
  PlanCacheStatistics plan_cache;
  FlightStatistics leaf_flights, plan_flights, tile_flights, geometry_flights;
  DurationHistogram tile_seconds;  // thread seconds per tile made
  std::uint64_t plans_made = 0;
  TurnStatistics turns;
  TileSkips skipped;
  PlanSkips left_out;
  CertificateCounts certificates;
};

/// A cell service that also tells what it did.
class MeasuredCellService : public CellService {
 public:
  virtual CellServiceStatistics statistics() const = 0;
  /// What each cell's own impostor cost so far, sorted by cell.
  virtual std::vector<CellStatistics> cell_statistics() const = 0;
};

std::unique_ptr<MeasuredCellService> make_cell_service(CellServiceParts parts);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/admin/server_metrics.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace farfield {
namespace {

double number(const std::atomic<std::uint64_t>& counter) {
  return static_cast<double>(counter.load(std::memory_order_relaxed));
}
double number(std::uint64_t value) { return static_cast<double>(value); }

// Tier by tier within each metric, as the text format wants them.
void write_store_metrics(PrometheusText& out, const CellServiceStatistics& shared) {
  const StoreStatistics& memory = shared.store;
  const MetricLabel in_memory{"tier", "memory"};
  const auto label_of = [](const BlobStoreStatistics& tier) { return MetricLabel{"tier", tier.tier}; };
  // Of Redis's size and what it forgot it tells itself, to its own exporter.
  const auto is_bounded_here = [](const BlobStoreStatistics& tier) { return tier.capacity_bytes > 0; };
  const auto gauge = [&](std::string_view name, std::string_view help, double of_memory, auto of_tier) {
    out.gauge(name, help, of_memory, in_memory);
    for (const BlobStoreStatistics& tier : shared.blobs)
      if (is_bounded_here(tier)) out.gauge(name, help, number(of_tier(tier)), label_of(tier));
  };
  const auto counter = [&](std::string_view name, std::string_view help, double of_memory, auto of_tier) {
    out.counter(name, help, of_memory, in_memory);
    for (const BlobStoreStatistics& tier : shared.blobs) out.counter(name, help, number(of_tier(tier)), label_of(tier));
  };
  const auto behind_memory = [&](std::string_view name, std::string_view help, auto of_tier) {
    for (const BlobStoreStatistics& tier : shared.blobs) out.counter(name, help, number(of_tier(tier)), label_of(tier));
  };
  using Tier = const BlobStoreStatistics&;
  gauge("farfield_store_bytes", "What is kept: encoded tiles in memory; tiles, plans and names of leaves on disk.", number(memory.bytes), [](Tier t) { return t.bytes; });
  gauge("farfield_store_items", "How many of them.", number(memory.items), [](Tier t) { return t.items; });
  gauge("farfield_store_capacity_bytes", "Bound of the bytes.", number(memory.capacity_bytes), [](Tier t) { return t.capacity_bytes; });
  counter("farfield_store_hits_total", "Found.", number(memory.hits), [](Tier t) { return t.hits; });
  counter("farfield_store_misses_total", "Not found.", number(memory.misses), [](Tier t) { return t.misses; });
  counter("farfield_store_evictions_total", "Forgotten for lack of room.", number(memory.evictions), [](Tier t) { return t.evictions; });
  behind_memory("farfield_store_writes_total", "Written.", [](Tier t) { return t.inserts; });
  behind_memory("farfield_store_writes_dropped_total", "Not written, the tier being full, gone or too slow: made again when next wanted.", [](Tier t) { return t.dropped; });
  behind_memory("farfield_store_rewritten_total", "Of what was written, there already: made by another server too.", [](Tier t) { return t.rewritten; });
  behind_memory("farfield_store_damaged_total", "Found, and not what was written: taken for missing.", [](Tier t) { return t.damaged; });
  for (const BlobStoreStatistics& tier : shared.blobs)
    out.gauge("farfield_store_reachable", "1, or 0 while everything is a miss because the tier is gone.", tier.is_reachable ? 1 : 0, label_of(tier));
}

}  // namespace

void write_metrics(PrometheusText& out, const SessionMetrics& m) {
  out.gauge("farfield_sessions_open", "Sessions connected now.", static_cast<double>(m.open_sessions.load()));
  out.counter("farfield_sessions_total", "Sessions welcomed.", number(m.sessions));
  out.counter("farfield_sessions_resumed_total", "Of these, continued after a cut.", number(m.resumed_sessions));
  out.counter("farfield_sessions_refused_total", "Connections sent away: full or draining.", number(m.refused_sessions));
  out.counter("farfield_access_refused_total", "Connections without a valid access token.", number(m.refused_tokens));
  out.counter("farfield_tls_handshakes_failed_total", "Cut, too slow, or no TLS at all.", number(m.failed_handshakes));

  out.counter("farfield_network_bytes_total", "Bytes on client sockets.", number(m.traffic->bytes_in), {"direction", "in"});
  out.counter("farfield_network_bytes_total", "", number(m.traffic->bytes_out), {"direction", "out"});
  out.counter("farfield_frames_total", "Frames on client sockets.", number(m.traffic->frames_in), {"direction", "in"});
  out.counter("farfield_frames_total", "", number(m.traffic->frames_out), {"direction", "out"});
  out.counter("farfield_frames_unknown_total", "Frames skipped: of a type this server does not know.", number(m.unknown_frames));
  out.counter("farfield_frames_bad_total", "Frames refused: garbage, too large, out of place.", number(m.bad_frames));

  out.counter("farfield_poses_total", "Poses received.", number(m.poses));
  out.counter("farfield_poses_dropped_total", "Poses overtaken by a newer one above the announced rate.", number(m.poses_dropped));
  out.counter("farfield_leaf_changes_deferred_total", "Leaf changes that waited: above the announced rate.", number(m.leaves_deferred));
  out.counter("farfield_leaf_sets_total", "Leaf set manifests sent.", number(m.leaf_sets));
  out.counter("farfield_leaf_sets_prefetched_total", "Of these, ahead of need.", number(m.leaf_sets_prefetched));
  out.counter("farfield_leaf_sets_fallback_total", "Of these, fallback views.", number(m.leaf_sets_fallback));
  out.counter("farfield_leaf_sets_reused_total", "Leaves entered whose manifest the client had.", number(m.leaf_sets_reused));
  out.counter("farfield_leaf_sets_complete_total", "Leaf sets sent to their end.", number(m.leaf_sets_complete));

  constexpr std::string_view kSent = "Payloads sent.";
  out.counter("farfield_payloads_total", kSent, number(m.payloads_tile), {"kind", "tile"});
  out.counter("farfield_payloads_total", kSent, number(m.payloads_empty_tile), {"kind", "empty_tile"});
  out.counter("farfield_payloads_total", kSent, number(m.payloads_chunk), {"kind", "chunk"});
  out.counter("farfield_payloads_total", kSent, number(m.payloads_texture), {"kind", "texture"});
  out.counter("farfield_payload_bytes_total", "Encoded bytes of payloads sent.", number(m.payload_bytes));
  out.counter("farfield_payloads_held_total", "Payloads of leaf sets not sent: the client held them.", number(m.payloads_held));
  out.counter("farfield_tiles_held_total", "Of these, tiles: of shells that neighbouring leaves share.", number(m.tiles_held));
  out.counter("farfield_payload_bytes_held_total", "Encoded bytes of these payloads.", number(m.payload_bytes_held));
  out.counter("farfield_leaves_blocked_ahead_total", "Leaves on predicted paths not made: nobody can stand in them.",
              number(m.leaves_blocked_ahead));
  out.counter("farfield_payloads_stale_total", "Payloads withdrawn before they were sent.", number(m.payloads_stale));
  out.counter("farfield_payloads_failed_total", "Payloads that could not be made when asked for.", number(m.payloads_failed));
}

void write_metrics(PrometheusText& out, std::span<const std::shared_ptr<MeasuredCellService>> services) {
  std::vector<CellServiceStatistics> all;
  for (const auto& service : services) all.push_back(service->statistics());
  if (all.empty()) return;
  const CellServiceStatistics& shared = all.front();
  out.gauge("farfield_queue_jobs", "Jobs waiting.", number(shared.queue.queued));
  out.gauge("farfield_queue_prefetch_jobs", "Of these, ahead of need.", number(shared.queue.queued_prefetch));
  out.gauge("farfield_queue_oldest_wait_seconds", "How long the oldest waiting job has waited.", shared.queue.oldest_wait_s);
  out.counter("farfield_queue_refused_total", "Jobs refused: the queue was full.", number(shared.queue.refused));
  out.gauge("farfield_cast_threads", "Threads that make tiles.", shared.pool.threads);
  out.gauge("farfield_cast_threads_busy", "Of these, inside a job now.", shared.pool.busy);
  out.counter("farfield_cast_jobs_total", "Jobs finished.", number(shared.pool.jobs));
  out.counter("farfield_cast_jobs_failed_total", "Jobs that let an exception escape.", number(shared.pool.failed));
  out.counter("farfield_cast_busy_seconds_total", "Thread seconds inside jobs.", shared.pool.busy_seconds);
  write_store_metrics(out, shared);

  const auto per_scene = [&](auto write) {
    for (std::size_t i = 0; i < all.size(); ++i) write(all[i], MetricLabel{"scene", services[i]->scene().name});
  };
  const auto count = [&](std::string_view name, std::string_view help, auto value_of) {
    per_scene([&](const CellServiceStatistics& s, MetricLabel scene) { out.counter(name, help, number(value_of(s)), scene); });
  };
  using Statistics = const CellServiceStatistics&;
  count("farfield_tile_flights_total", "Tiles begun to be made, turned away to wait for another server included.", [](Statistics s) { return s.tile_flights.begun; });
  count("farfield_tile_flights_shared_total", "Requests that joined work already under way.", [](Statistics s) { return s.tile_flights.shared; });
  count("farfield_tile_flights_cancelled_total", "Tiles given up: nobody wanted them any more.", [](Statistics s) { return s.tile_flights.cancelled; });
  count("farfield_tiles_made_total", "Tiles made.", [](Statistics s) { return s.tile_seconds.count; });
  count("farfield_leaf_plans_total", "Leaf plans begun to be made, likewise.", [](Statistics s) { return s.plan_flights.begun; });
  count("farfield_leaf_plans_made_total", "Leaf plans made.", [](Statistics s) { return s.plans_made; });
  count("farfield_leases_total", "Tiles and plans made holding a lease, so that no other server made them.", [](Statistics s) { return s.turns.leases; });
  count("farfield_leases_missing_total", "Tiles and plans made without: no lease could be had, or its holder took too long.", [](Statistics s) { return s.turns.alone; });
  count("farfield_lease_waits_total", "Waits of requests for what another server made.", [](Statistics s) { return s.turns.waits; });
  count("farfield_lease_waits_in_vain_total", "Of these, ended by making it here.", [](Statistics s) { return s.turns.waits_in_vain; });
  count("farfield_tiles_empty_total", "Tiles that held nothing and were not sent.", [](Statistics s) { return s.skipped.empty_tiles; });
  count("farfield_tiles_unseen_total", "Tiles not made: nothing of them can be seen from the leaf planned.", [](Statistics s) { return s.left_out.tiles_unseen; });
  count("farfield_tiles_too_small_total", "Tiles not made: too little of them can be seen from the leaf planned.",
        [](Statistics s) { return s.left_out.tiles_too_small; });
  count("farfield_delta_views_unneeded_total", "Delta views allowed and not made: voids were below the target.",
        [](Statistics s) { return s.left_out.delta_views_unneeded; });
  count("farfield_chunks_facing_away_total", "Chunks of near regions not sent: they face away from all of the leaf.",
        [](Statistics s) { return s.left_out.chunks_facing_away; });
  count("farfield_chunks_unseen_total", "Chunks of near regions not sent: no ray from the leaf reaches them.",
        [](Statistics s) { return s.left_out.chunks_unseen; });
  count("farfield_triangles_unseen_total", "Triangles of all these chunks.", [](Statistics s) { return s.left_out.triangles_unseen; });
  count("farfield_cells_blocked_total", "Leaves planned in which nobody can stand: one view each.", [](Statistics s) { return s.left_out.blocked_cells; });
  count("farfield_samples_coloured_once_total", "Samples coloured from one ray: more would have changed nothing.", [](Statistics s) { return s.skipped.samples_coloured_once; });
  count("farfield_samples_hidden_total", "Samples not cast: nobody in their leaf can see them.", [](Statistics s) { return s.skipped.hidden_samples; });
  count("farfield_delta_blocks_not_cast_total", "Blocks of delta views not cast: earlier views hold them.",
        [](Statistics s) { return s.skipped.delta_blocks_not_cast; });
  count("farfield_delta_blocks_hidden_total", "Blocks of delta views not probed: nobody in their leaf can see them.",
        [](Statistics s) { return s.skipped.delta_blocks_hidden; });
  count("farfield_samples_without_depth_total", "Samples coded without depth: parallax within their cell stays below the tolerance.",
        [](Statistics s) { return s.skipped.samples_without_depth; });
  count("farfield_tiles_identical_total", "Tiles that show what another cell's tile shows; each is sent under its own name.",
        [](Statistics s) { return s.skipped.identical_tiles; });
  count("farfield_tile_bytes_identical_total", "Encoded bytes of these tiles.", [](Statistics s) { return s.skipped.identical_bytes; });
  count("farfield_delta_samples_held_total", "Samples of delta views not kept: earlier views hold them.",
        [](Statistics s) { return s.skipped.delta_samples_held; });
  count("farfield_tiles_certified_total", "Tiles measured beside truth.", [](Statistics s) { return s.certificates.certified; });
  count("farfield_certificates_refined_total", "Tiles coded finer to meet their target.", [](Statistics s) { return s.certificates.refined; });
  count("farfield_certificates_missed_total", "Tiles that could not meet their target, or whose shell's voids could not.",
        [](Statistics s) { return s.certificates.missed; });
  per_scene([&](Statistics s, MetricLabel scene) { out.histogram("farfield_tile_seconds", "Thread seconds per tile made.", s.tile_seconds, scene); });
}

void write_process_metrics(PrometheusText& out) {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t total_pages = 0, resident_pages = 0;
  if (statm >> total_pages >> resident_pages) {
    out.gauge("process_resident_memory_bytes", "Resident memory size in bytes.",
              static_cast<double>(resident_pages) * static_cast<double>(sysconf(_SC_PAGESIZE)));
  }
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
    out.counter("process_cpu_seconds_total", "Total user and system CPU time spent in seconds.",
                seconds(usage.ru_utime) + seconds(usage.ru_stime));
  }
}

}  // namespace farfield

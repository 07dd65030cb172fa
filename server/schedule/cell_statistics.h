// SPDX-License-Identifier: Apache-2.0
// What making each cell's impostor cost: the benchmark's generation time and bytes per cell (design.md section 9).
//
// Times are thread seconds, so a cell made alone by n threads takes seconds / n: queueing, and work on other cells
// interleaved with it, do not count. Tiles answered from the store are not counted again.
#pragma once

#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "server/cells/leaf_plan.h"
#include "server/encode/tile_source.h"
#include "server/schedule/duration_histogram.h"

namespace farfield {

/// One cell's own impostor: intra and delta tiles of its shell. The fallback view stands beside it.
struct CellStatistics {
  CellId cell;
  bool is_leaf = false;           // a leaf plan was made for it
  double seconds = 0;             // casting, shading, encoding and certifying …
  StageSeconds stages;            // … of which
  double fallback_seconds = 0;    // making the fallback view; not in `seconds`
  double visibility_seconds = 0;  // making the leaf plan; not in `seconds`
  std::uint32_t tiles = 0;        // not empty, fallback view left out
  std::uint32_t empty_tiles = 0;  // made, and found to hold nothing
  std::uint64_t covered_samples = 0;
  std::uint64_t rays = 0;         // EncodedTile::rays
  std::uint64_t bytes = 0, colour_bytes = 0, disparity_bytes = 0, other_bytes = 0;
  TileSkips skipped;              // of its tiles
  // Of leaves, as last planned:
  std::uint32_t listed_tiles = 0, chunks = 0, near_triangles = 0;
  int delta_views = -1;
  LeafSkips left_out;
};

/// Thread-safe.
class CellStatisticsRecorder {
 public:
  /// Cells beyond this many are counted in dropped() only: statistics must not grow with what viewers visit.
  explicit CellStatisticsRecorder(std::size_t max_cells = 65'536) : max_cells_(max_cells) {}

  void add_tile(const TileId& id, const EncodedTile& tile);
  void add_plan(const LeafPlan& plan);

  /// All cells, sorted by id.
  std::vector<CellStatistics> cells() const;
  /// Thread seconds of every tile made, whatever its cell.
  DurationHistogram tile_seconds() const;
  std::uint64_t plans() const;  // made, whatever their cell
  std::uint64_t dropped() const;

 private:
  CellStatistics* record_of(const CellId& cell);

  const std::size_t max_cells_;
  mutable std::mutex mutex_;  // guards everything below
  std::unordered_map<CellId, CellStatistics> cells_;
  DurationHistogram tile_seconds_;
  std::uint64_t plans_ = 0, dropped_ = 0;
};

}  // namespace farfield

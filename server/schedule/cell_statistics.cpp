// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/cell_statistics.h"

#include <algorithm>

namespace farfield {

CellStatistics* CellStatisticsRecorder::record_of(const CellId& cell) {
  const auto known = cells_.find(cell);
  if (known != cells_.end()) return &known->second;
  if (cells_.size() >= max_cells_) {
    ++dropped_;
    return nullptr;
  }
  CellStatistics& record = cells_[cell];
  record.cell = cell;
  return &record;
}

void CellStatisticsRecorder::add_tile(const TileId& id, const EncodedTile& tile) {
  const std::scoped_lock lock(mutex_);
  tile_seconds_.add(tile.seconds);
  CellStatistics* record = record_of(id.cell);
  if (!record) return;
  if (id.view == kFallbackView) {
    record->fallback_seconds += tile.seconds;
    return;
  }
  const std::size_t bytes = tile.bytes ? tile.bytes->size() : 0;
  ++(bytes > 0 ? record->tiles : record->empty_tiles);
  record->seconds += tile.seconds;
  record->stages += tile.stages;
  record->covered_samples += tile.covered_samples;
  record->bytes += bytes;
  record->colour_bytes += tile.colour_bytes;
  record->disparity_bytes += tile.disparity_bytes;
  record->other_bytes += tile.other_bytes;
  record->rays += tile.rays;
  record->skipped += tile.skips;
}

void CellStatisticsRecorder::add_plan(const LeafPlan& plan) {
  const std::scoped_lock lock(mutex_);
  ++plans_;
  if (CellStatistics* record = record_of(plan.leaf)) {
    record->is_leaf = true;
    record->visibility_seconds += plan.seconds;
    record->listed_tiles = static_cast<std::uint32_t>(plan.tiles.size());
    record->chunks = static_cast<std::uint32_t>(plan.chunks.size());
    record->near_triangles = plan.near_triangles;
    record->delta_views = plan.delta_views;
    record->left_out = plan.skips;
  }
}

std::vector<CellStatistics> CellStatisticsRecorder::cells() const {
  std::vector<CellStatistics> result;
  {
    const std::scoped_lock lock(mutex_);
    result.reserve(cells_.size());
    for (const auto& [id, record] : cells_) result.push_back(record);
  }
  std::sort(result.begin(), result.end(),
            [](const CellStatistics& a, const CellStatistics& b) { return a.cell < b.cell; });
  return result;
}

DurationHistogram CellStatisticsRecorder::tile_seconds() const {
  const std::scoped_lock lock(mutex_);
  return tile_seconds_;
}

std::uint64_t CellStatisticsRecorder::plans() const {
  const std::scoped_lock lock(mutex_);
  return plans_;
}

std::uint64_t CellStatisticsRecorder::dropped() const {
  const std::scoped_lock lock(mutex_);
  return dropped_;
}

}  // namespace farfield

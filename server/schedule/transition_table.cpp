// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/transition_table.h"

#include <algorithm>
#include <cmath>

#include "common/cells/cell_bytes.h"

namespace farfield {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kCountBytes = kCellBytes + 3 * 8 + 4;
constexpr std::uint8_t kNoLevel = 255;

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

void TransitionTable::add(Row& row, const CellId& next, const glm::dvec3& entry) {
  const auto found = std::find_if(row.counts.begin(), row.counts.end(), [&](const Count& count) { return count.leaf == next; });
  if (found == row.counts.end()) {
    if (row.counts.size() >= kMostNext) return;
    row.counts.push_back({next, entry, 1});
  } else {
    ++found->count;
    found->entry = entry;
  }
  if (++row.total < kMostCounted) return;
  row.total = 0;
  for (Count& count : row.counts) row.total += count.count /= 2;
  std::erase_if(row.counts, [](const Count& count) { return count.count == 0; });
}

void TransitionTable::make_room() {
  if (rows_.size() < capacity_) return;
  // A quarter at once, so that sorting is paid for by many notes.
  std::vector<std::uint32_t> totals;
  for (const auto& [way, row] : rows_) totals.push_back(row.total);
  const auto bound = totals.begin() + static_cast<std::ptrdiff_t>(totals.size() / 4);
  std::nth_element(totals.begin(), bound, totals.end());
  std::size_t left = totals.size() / 4 + 1;
  std::erase_if(rows_, [&, limit = *bound](const auto& row) { return row.second.total <= limit && left > 0 && left-- > 0; });
}

void TransitionTable::note(const std::optional<CellId>& previous, const CellId& current, const CellId& next, const glm::dvec3& entry) {
  const std::lock_guard lock(mutex_);
  make_room();
  ++noted_;
  add(rows_[{kNowhere, current}], next, entry);
  if (previous) add(rows_[{*previous, current}], next, entry);
}

Departures TransitionTable::from(const std::optional<CellId>& previous, const CellId& current) const {
  Departures departures;
  const std::lock_guard lock(mutex_);
  auto found = previous ? rows_.find({*previous, current}) : rows_.end();
  if (found == rows_.end()) found = rows_.find({kNowhere, current});
  if (found == rows_.end()) return departures;
  departures.seen = found->second.total;
  for (const Count& count : found->second.counts) {
    departures.next.push_back({count.leaf, count.entry, static_cast<double>(count.count) / (found->second.total + 1.0)});
  }
  std::sort(departures.next.begin(), departures.next.end(), [](const LikelyNext& a, const LikelyNext& b) { return a.probability > b.probability; });
  return departures;
}

Bytes TransitionTable::write() const {
  const std::lock_guard lock(mutex_);
  ByteWriter out;
  out.put(kVersion);
  for (const auto& [way, row] : rows_) {
    put_cell(out, way.previous), put_cell(out, way.current);
    out.put(static_cast<std::uint8_t>(row.counts.size()));
    for (const Count& count : row.counts) {
      put_cell(out, count.leaf);
      out.put(count.entry.x), out.put(count.entry.y), out.put(count.entry.z), out.put(count.count);
    }
  }
  return out.take();
}

Status TransitionTable::read(ByteView bytes) {
  ByteReader in(bytes);
  const auto bad = [] { return fail(ErrorCode::kBadData, "what was learned of viewers' ways cannot be read"); };
  if (in.get<std::uint8_t>() != kVersion) return bad();
  std::unordered_map<Way, Row, WayHash> rows;
  while (in.ok() && in.remaining() > 0) {
    Way way{get_cell(in), get_cell(in)};
    const std::size_t counts = in.get<std::uint8_t>();
    if (counts > kMostNext || in.remaining() < counts * kCountBytes || rows.size() >= capacity_) return bad();
    if (way.current.level > kMaxCellLevel || (way.previous.level > kMaxCellLevel && way.previous.level != kNoLevel)) return bad();
    Row row;
    for (std::size_t k = 0; k < counts; ++k) {
      Count count{get_cell(in), {in.get<double>(), in.get<double>(), in.get<double>()}, in.get<std::uint32_t>()};
      if (count.leaf.level > kMaxCellLevel || !is_finite(count.entry) || count.count == 0 || count.count > kMostCounted) return bad();
      row.total += count.count;
      row.counts.push_back(count);
    }
    rows[way] = std::move(row);
  }
  if (!in.ok()) return bad();
  const std::lock_guard lock(mutex_);
  rows_ = std::move(rows);
  noted_ = 0;
  return {};
}

std::uint64_t TransitionTable::noted() const {
  const std::lock_guard lock(mutex_);
  return noted_;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/store/blob_records.h"

#include <algorithm>
#include <cmath>

#include "common/cells/cell_bytes.h"

namespace farfield {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::uint8_t kExceedsBudget = 1, kBackgroundVisible = 2, kIsFallback = 4;
constexpr std::size_t kTileBytes = 21, kLeastPlanBytes = 40;  // of one in a plan's lists, at least

tl::unexpected<Error> bad(const char* what) { return fail(ErrorCode::kBadData, "a stored {} is not what this version writes", what); }

bool is_cell(const CellId& cell) { return cell.level <= kMaxCellLevel; }

void put_sized(ByteWriter& out, ByteView bytes) { out.put_varint(bytes.size()), out.put_bytes(bytes); }

ByteView get_sized(ByteReader& in) { return in.get_bytes(static_cast<std::size_t>(std::min<std::uint64_t>(in.get_varint(), in.remaining() + 1))); }

void put_plan(ByteWriter& out, const LeafPlan& plan) {
  put_cell(out, plan.leaf), put_cell(out, plan.root);
  out.put(static_cast<std::uint8_t>((plan.exceeds_budget ? kExceedsBudget : 0) | (plan.background_visible ? kBackgroundVisible : 0) | (plan.is_fallback ? kIsFallback : 0)));
  out.put(plan.near_triangles);
  out.put(static_cast<std::int8_t>(plan.delta_views));
  put_sized(out, plan.enclosure.bytes()), put_sized(out, plan.sky.bytes());
  out.put_varint(plan.tiles.size());
  for (const NeededTile& tile : plan.tiles) {
    put_cell(out, tile.id.cell);
    out.put(tile.id.view), out.put(tile.id.face), out.put(tile.id.x), out.put(tile.id.y), out.put(tile.view_share);
  }
  out.put_varint(plan.chunks.size());
  for (const std::uint32_t chunk : plan.chunks) out.put_varint(chunk);
  out.put_varint(plan.enclosures.size());
  for (const SharedPlan& part : plan.enclosures) put_plan(out, *part);
}

// How many of a list follow; more than there are bytes for are none.
std::size_t get_count(ByteReader& in, std::size_t least_bytes) {
  const std::uint64_t count = in.get_varint();
  return count <= in.remaining() / least_bytes ? static_cast<std::size_t>(count) : std::size_t{0} - 1;
}

Result<SharedPlan> get_plan(ByteReader& in, std::size_t chunks, bool may_divide) {
  constexpr std::size_t kTooMany = std::size_t{0} - 1;
  auto plan = std::make_shared<LeafPlan>();
  plan->leaf = get_cell(in), plan->root = get_cell(in);
  if (!is_cell(plan->leaf) || !is_cell(plan->root)) return bad("plan");
  const auto flags = in.get<std::uint8_t>();
  plan->exceeds_budget = flags & kExceedsBudget, plan->background_visible = flags & kBackgroundVisible;
  plan->is_fallback = flags & kIsFallback;
  plan->near_triangles = in.get<std::uint32_t>();
  plan->delta_views = in.get<std::int8_t>();
  if (const ByteView mask = get_sized(in); !mask.empty()) {
    auto enclosure = EnclosureMask::from_bytes(mask);
    if (!enclosure) return tl::unexpected(enclosure.error());
    plan->enclosure = std::move(*enclosure);
  }
  plan->sky = DirectionMask::from_bytes(get_sized(in));
  const std::size_t tiles = get_count(in, kTileBytes);
  if (tiles == kTooMany) return bad("plan");
  plan->tiles.resize(tiles);
  for (NeededTile& tile : plan->tiles) {
    tile.id.cell = get_cell(in);
    tile.id.view = in.get<std::uint8_t>(), tile.id.face = in.get<std::uint8_t>();
    tile.id.x = in.get<std::uint8_t>(), tile.id.y = in.get<std::uint8_t>(), tile.view_share = in.get<float>();
    if (!is_cell(tile.id.cell) || tile.id.face >= kCubeFaces || !std::isfinite(tile.view_share)) return bad("plan");
  }
  const std::size_t listed = get_count(in, 1);
  if (listed == kTooMany) return bad("plan");
  plan->chunks.resize(listed);
  for (std::uint32_t& chunk : plan->chunks) {
    const std::uint64_t index = in.get_varint();
    if (index >= chunks) return bad("plan");
    chunk = static_cast<std::uint32_t>(index);
  }
  const std::size_t parts = get_count(in, kLeastPlanBytes);
  if (parts == kTooMany || (parts > 0 && !may_divide)) return bad("plan");
  for (std::size_t k = 0; k < parts; ++k) {
    Result<SharedPlan> part = get_plan(in, chunks, false);
    if (!part) return part;
    plan->enclosures.push_back(std::move(*part));
  }
  if (!in.ok()) return bad("plan");
  return plan;
}

// Room at the beginning, so that short records grow once.
ByteWriter record_of(std::size_t bytes) {
  ByteWriter out;
  out.bytes().reserve(bytes + 64);
  out.put(kVersion);
  return out;
}

bool has_version(ByteReader& in) { return in.get<std::uint8_t>() == kVersion; }

}  // namespace

Bytes write_tile_record(const EncodedTile& tile) {
  ByteWriter out = record_of(tile.bytes->size());
  out.put(tile.covered_samples), out.put(tile.colour_bytes), out.put(tile.disparity_bytes), out.put(tile.other_bytes), out.put(tile.rays);
  out.put_bytes(*tile.bytes);
  return out.take();
}

Result<std::shared_ptr<const EncodedTile>> read_tile_record(ByteView bytes) {
  ByteReader in(bytes);
  auto tile = std::make_shared<EncodedTile>();
  if (!has_version(in)) return bad("tile");
  tile->covered_samples = in.get<std::uint32_t>(), tile->colour_bytes = in.get<std::uint32_t>();
  tile->disparity_bytes = in.get<std::uint32_t>(), tile->other_bytes = in.get<std::uint32_t>(), tile->rays = in.get<std::uint32_t>();
  if (!in.ok()) return bad("tile");
  const ByteView encoded = in.get_bytes(in.remaining());
  tile->bytes = std::make_shared<const Bytes>(encoded.begin(), encoded.end());
  if (!encoded.empty()) tile->hash = hash_bytes(encoded);
  return tile;
}

Bytes write_plan_record(const LeafPlan& plan) {
  ByteWriter out = record_of(plan.tiles.size() * kTileBytes);
  put_plan(out, plan);
  return out.take();
}

Result<SharedPlan> read_plan_record(ByteView bytes, std::size_t chunks) {
  ByteReader in(bytes);
  if (!has_version(in)) return bad("plan");
  Result<SharedPlan> plan = get_plan(in, chunks, true);
  if (plan && in.remaining() > 0) return bad("plan");
  return plan;
}

Bytes write_leaf_name_record(const LeafName& name) {
  ByteWriter out = record_of(0);
  put_cell(out, name.leaf);
  out.put(static_cast<std::uint8_t>(name.is_blocked));
  return out.take();
}

Result<LeafName> read_leaf_name_record(ByteView bytes) {
  ByteReader in(bytes);
  LeafName name;
  if (!has_version(in)) return bad("leaf's name");
  name.leaf = get_cell(in);
  name.is_blocked = in.get<std::uint8_t>() != 0;
  if (!in.ok() || in.remaining() > 0 || !is_cell(name.leaf)) return bad("leaf's name");
  return name;
}

}  // namespace farfield

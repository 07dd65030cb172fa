// SPDX-License-Identifier: Apache-2.0
// Leaf sets and payloads made up for tests: a grid of finest side 1 m, so that leaf i stands at x = i … i + 1.
#pragma once

#include <memory>
#include <string>

#include "client/store/leaf_sets.h"

namespace farfield::client::made {

inline constexpr std::size_t kTileBytes = 1000;

inline SceneFrame frame() { return {CellGrid{1.0}, 2.0, {1, 2, 3}}; }
inline glm::dvec3 eye_in(int leaf) { return {leaf + 0.5, 0.5, 0.5}; }
inline CellId leaf_at(int leaf) { return frame().grid.cell_at(eye_in(leaf), 0); }

inline LeafSet leaf_set(std::uint64_t serial, int leaf, std::vector<ContentHash> tiles, bool is_current = true) {
  LeafSet set;
  set.serial = serial;
  set.leaf = leaf_at(leaf);
  set.root = leaf_at(leaf).ancestor(4);
  set.is_current = is_current;
  set.tiles = std::move(tiles);
  return set;
}

/// Holds in one half of the leaf along x only.
inline LeafSet half_set(std::uint64_t serial, int leaf, bool is_upper, std::vector<ContentHash> tiles) {
  LeafSet set = leaf_set(serial, leaf, std::move(tiles));
  EnclosureMaskWriter half;
  half.divide();
  for (int child = 0; child < 8; ++child) half.fill((child & 1) == (is_upper ? 1 : 0));
  set.enclosure = EnclosureMask::from_bytes(half.take()).value();
  return set;
}

inline LeafSet fallback_set(std::uint64_t serial, int leaf, std::vector<ContentHash> tiles) {
  LeafSet set = leaf_set(serial, leaf, std::move(tiles));
  set.is_fallback = true;
  return set;
}

inline DecodedPayload tile(ContentHash key, std::size_t bytes = kTileBytes) {
  auto decoded = std::make_shared<DecodedTile>();
  decoded->serial = next_serial();
  decoded->memory_bytes = bytes;
  DecodedPayload payload;
  payload.name = {PayloadKind::kTile, key, 0, 0};
  payload.tile = std::move(decoded);
  payload.memory_bytes = bytes;
  return payload;
}

inline DecodedPayload delta_tile(ContentHash key) {
  DecodedPayload payload = tile(key);
  auto delta = std::make_shared<DecodedTile>(*payload.tile);
  delta->id.view = kIntraView + 1;
  payload.tile = std::move(delta);
  return payload;
}

inline DecodedPayload chunk(ContentHash hash, std::size_t bytes = kTileBytes) {
  auto decoded = std::make_shared<DecodedChunk>();
  decoded->hash = hash;
  decoded->serial = next_serial();
  DecodedPayload payload;
  payload.name = {PayloadKind::kChunk, hash, 0, 0};
  payload.chunk = std::move(decoded);
  payload.memory_bytes = bytes;
  return payload;
}

/// A packed tile of one splat: the smallest there is.
inline Tile tiny_tile(const CellId& cell) {
  Tile tile;
  tile.id = {cell, 1, 0, 0, 0};
  tile.edge_samples = face_samples(2);
  tile.width = tile.height = kBlockSamples;
  tile.blocks = {{0, 0}};
  tile.coverage.assign(tile.samples(), 0);
  tile.coverage[0] = 1;
  tile.disparity.assign(tile.samples(), 0.1f);
  tile.rgb.assign(3 * tile.samples(), 7);
  tile.cut_right.assign(tile.samples(), 0);
  tile.cut_down.assign(tile.samples(), 0);
  tile.disparity_tolerance = 1e-3f;
  return tile;
}

/// A level of edge·edge texels.
inline DecodedPayload texture_level(ContentHash texture, int level, int edge) {
  DecodedPayload payload;
  payload.name = {PayloadKind::kTextureLevel, texture * 100 + static_cast<ContentHash>(level), texture, level};
  payload.texture_level = {texture, level, 8, edge, edge, Bytes(static_cast<std::size_t>(4 * edge * edge), 1)};
  payload.memory_bytes = sizeof(TextureLevel) + payload.texture_level.rgba.size();
  return payload;
}

}  // namespace farfield::client::made

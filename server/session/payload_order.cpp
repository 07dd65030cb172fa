// SPDX-License-Identifier: Apache-2.0
#include "server/session/payload_order.h"

#include <algorithm>
#include <numeric>
#include <unordered_set>

namespace farfield {

ContentHash tile_payload_key(ContentHash scene_hash, const TileId& id) {
  ByteWriter name;
  name.put(id.cell.level);
  name.put(id.cell.x);
  name.put(id.cell.y);
  name.put(id.cell.z);
  for (const std::uint8_t part : {id.view, id.face, id.x, id.y}) name.put(part);
  return hash_bytes(name.bytes(), scene_hash);
}

ContentHash texture_payload_key(ContentHash texture_hash, int level) { return hash_value(level, texture_hash); }

std::vector<PayloadItem> payload_order(const CellService& service, const LeafPlan& plan) {
  std::vector<PayloadItem> items;
  std::vector<std::uint32_t> textures;  // in order of first use
  std::unordered_set<ContentHash> listed;
  const auto add = [&](PayloadItem::Kind kind, ContentHash key, std::uint32_t index, int level) {
    if (listed.insert(key).second) items.push_back({key, index, kind, static_cast<std::uint8_t>(level)});
  };
  const auto add_level = [&](std::uint32_t index, const SceneTexture& texture, int level) {
    add(PayloadItem::Kind::kTexture, texture_payload_key(texture.hash, level), index, level);
  };

  std::unordered_set<int> seen_textures;
  for (const std::uint32_t chunk : plan.chunks) {
    const PlacedSceneChunk placed = service.chunk_placement(chunk);
    add(PayloadItem::Kind::kChunk, placed.hash, chunk, 0);
    if (placed.texture < 0 || !seen_textures.insert(placed.texture).second) continue;
    const auto index = static_cast<std::uint32_t>(placed.texture);
    textures.push_back(index);
    const SceneTexture texture = service.texture(index);
    for (int level = texture.level_count - 1; level >= 0 && is_coarse_level(texture, level); --level) {
      add_level(index, texture, level);
    }
  }

  const ContentHash scene_hash = service.scene().hash;
  std::vector<std::uint32_t> tiles(plan.tiles.size());
  std::iota(tiles.begin(), tiles.end(), 0u);
  // Stable: within a shell the larger share of the view stays first.
  std::stable_sort(tiles.begin(), tiles.end(), [&](std::uint32_t a, std::uint32_t b) {
    return plan.tiles[a].id.cell.level > plan.tiles[b].id.cell.level;
  });
  for (const std::uint32_t i : tiles) add(PayloadItem::Kind::kTile, tile_payload_key(scene_hash, plan.tiles[i].id), i, 0);

  // Level by level, coarse to fine, so that all textures sharpen together. A fallback view does without.
  for (int level = plan.is_fallback ? -1 : 15; level >= 0; --level) {
    for (const std::uint32_t index : textures) {
      const SceneTexture texture = service.texture(index);
      if (level < texture.level_count && !is_coarse_level(texture, level)) add_level(index, texture, level);
    }
  }
  return items;
}

}  // namespace farfield

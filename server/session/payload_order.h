// SPDX-License-Identifier: Apache-2.0
// The payloads of one leaf set in the order in which they are worth sending.
//
//   chunks, nearest first, each with the coarse levels of its texture ─▶ tiles, outermost shell first ─▶ finer levels
//
// A set is shown whole, so within it the order of tiles decides only what is wasted when the viewer leaves before it
// is complete. The outer shells are the next leaf's as well, and the leaf's own shell nobody else's: outermost first,
// every tile made shortens the way to the next complete set, however fast the viewer walks.
#pragma once

#include <cstdint>
#include <vector>

#include "server/schedule/cell_service.h"

namespace farfield {

/// Texture levels with no edge above this many texels are coarse: they come with the geometry.
inline constexpr int kCoarseTextureEdge = 64;

inline bool is_coarse_level(const SceneTexture& texture, int level) {
  return (texture.width > texture.height ? texture.width : texture.height) >> level <= kCoarseTextureEdge;
}

struct PayloadItem {
  enum class Kind : std::uint8_t { kTile, kChunk, kTexture };
  ContentHash key = 0;
  std::uint32_t index = 0;   // tile: in the plan's tiles; chunk or texture: as the service counts
  Kind kind = Kind::kTile;
  std::uint8_t level = 0;    // of a texture
};

/// Keys that both sides may keep for as long as the scene's hash is the same: proto/README.md.
ContentHash tile_payload_key(ContentHash scene_hash, const TileId& id);
ContentHash texture_payload_key(ContentHash texture_hash, int level);

/// Every payload once; a fallback view does without finer texture levels. O(payloads · log(payloads)).
std::vector<PayloadItem> payload_order(const CellService& service, const LeafPlan& plan);

}  // namespace farfield

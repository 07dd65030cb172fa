// SPDX-License-Identifier: Apache-2.0
#include "client/near/near_batches.h"

#include <map>
#include <tuple>

#include "client/near/clip_surface.h"
#include "common/base/hash.h"

namespace farfield::client {

ContentHash near_geometry_key(const LeafView& leaf) {
  std::vector<std::uint32_t> words;
  words.reserve(16 * leaf.chunks.size());
  const auto add = [&](const auto& value) {
    const std::size_t at = words.size();
    static_assert(sizeof(value) % 4 == 0);
    words.resize(at + sizeof(value) / 4);
    std::memcpy(words.data() + at, &value, sizeof(value));
  };
  add(leaf.leaf_box.center());
  add(leaf.near_region.min);
  add(leaf.near_region.max);
  for (const PlacedChunk& placed : leaf.chunks) {
    add(placed.chunk ? placed.chunk->serial : std::uint64_t{0});
    add(placed.cell_from_chunk);
  }
  return hash_values(std::span<const std::uint32_t>(words));
}

NearBatches near_batches(const LeafView& leaf) {
  const glm::dvec3 centre = leaf.leaf_box.center();
  const SurfaceBounds region{glm::vec3(leaf.near_region.min - centre), glm::vec3(leaf.near_region.max - centre)};
  NearBatches result;
  std::map<std::tuple<bool, ContentHash, float>, std::size_t> batch_of;
  for (std::uint32_t i = 0; i < leaf.chunks.size(); ++i) {
    const PlacedChunk& placed = leaf.chunks[i];
    if (!placed.chunk) continue;
    const Chunk& chunk = placed.chunk->chunk;
    MergedChunk merged;
    const std::size_t first_vertex = result.vertices.size();
    merged.first_index = static_cast<std::uint32_t>(result.indices.size());
    merged.bounds = append_surface(chunk, placed.cell_from_chunk, result.vertices, result.indices);
    const bool is_outside = glm::any(glm::lessThan(merged.bounds.max, region.min)) ||
                            glm::any(glm::greaterThanEqual(merged.bounds.min, region.max));
    if (is_outside) {
      result.indices.resize(merged.first_index);
    } else if (glm::any(glm::lessThan(merged.bounds.min, region.min)) ||
               glm::any(glm::greaterThanEqual(merged.bounds.max, region.max))) {
      clip_surface(region, merged.first_index, result.vertices, result.indices);
      merged.bounds = {glm::max(merged.bounds.min, region.min), glm::min(merged.bounds.max, region.max)};
    }
    merged.index_count = static_cast<std::uint32_t>(result.indices.size()) - merged.first_index;
    if (merged.index_count == 0) {
      result.vertices.resize(first_vertex);
      continue;
    }
    const auto key = std::tuple(chunk.is_alpha_masked, chunk.texture, chunk.is_alpha_masked ? chunk.alpha_cutoff : 0.0f);
    const auto [at, is_new] = batch_of.try_emplace(key, result.batches.size());
    if (is_new) result.batches.push_back({chunk.texture, i, chunk.is_alpha_masked, chunk.alpha_cutoff, {}});
    result.batches[at->second].chunks.push_back(merged);
  }
  return result;
}

}  // namespace farfield::client

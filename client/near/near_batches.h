// SPDX-License-Identifier: Apache-2.0
// The near geometry of one leaf set merged into batches that need one draw call each. CPU only.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "client/near/surface_vertex.h"
#include "client/store/leaf_view.h"

namespace farfield::client {

/// Names what near_batches() would make of a leaf set: equal keys, equal geometry.
ContentHash near_geometry_key(const LeafView& leaf);

struct MergedChunk {
  SurfaceBounds bounds;
  std::uint32_t first_index = 0, index_count = 0;
};

/// Chunks of one texture and mask.
struct NearBatch {
  ContentHash texture = 0;         // content hash, 0: none
  std::uint32_t placed_chunk = 0;  // an index into LeafView::chunks: where to find the texture
  bool is_alpha_masked = false;
  float alpha_cutoff = 0.5f;
  std::vector<MergedChunk> chunks;  // in the leaf set's order
};

struct NearBatches {
  std::vector<SurfaceVertex> vertices;  // relative to the leaf's centre
  std::vector<std::uint32_t> indices;
  std::vector<NearBatch> batches;
};

/// Cut at the border of the near region; chunks entirely outside it are left out.
NearBatches near_batches(const LeafView& leaf);

}  // namespace farfield::client

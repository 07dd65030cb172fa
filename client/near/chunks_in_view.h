// SPDX-License-Identifier: Apache-2.0
// What of a leaf set's near geometry a frame draws: chunks that may be in view, by batches, nearest first, so that most of
// what lies behind fails the depth test before its colour is asked for. CPU only.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "client/gl/view_transform.h"
#include "client/near/near_batches.h"

namespace farfield::client {

struct NearStatistics {
  std::uint64_t triangles = 0;       // drawn after culling
  std::uint64_t triangles_held = 0;  // of the leaf set
  std::uint32_t draw_calls = 0, chunks_drawn = 0;
  std::uint64_t uploaded_bytes = 0;  // new geometry and textures of this frame
};

/// What of a batch a frame draws.
struct BatchInView {
  const NearBatch* batch = nullptr;
  std::size_t first_index = 0, index_count = 0;  // of ChunksInView::indices
  double distance = 0;                           // squared, of its nearest chunk
};

struct ChunksInView {
  std::vector<std::uint32_t> indices;  // three per triangle, of the leaf set's vertices
  std::vector<BatchInView> batches;
  std::vector<std::pair<double, const MergedChunk*>> of_batch;  // while one is looked at: squared distances

  /// Finds them anew. `leaf_indices`: of all chunks of `leaf_batches`; `centre`: what their positions are relative to, scene
  /// frame. Counts all but uploads in `statistics`.
  void find(const std::vector<NearBatch>& leaf_batches, const std::vector<std::uint32_t>& leaf_indices,
            const glm::dvec3& centre, const ViewTransform& view, NearStatistics& statistics);
};

}  // namespace farfield::client

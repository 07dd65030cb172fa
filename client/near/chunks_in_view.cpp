// SPDX-License-Identifier: Apache-2.0
#include "client/near/chunks_in_view.h"

#include <algorithm>

namespace farfield::client {
namespace {

AffineBox in_camera(const SurfaceBounds& bounds, const glm::dvec3& eye_from_centre, const glm::dmat3& rotation) {
  const glm::dvec3 half = 0.5 * (glm::dvec3(bounds.max) - glm::dvec3(bounds.min));
  return {rotation * (0.5 * (glm::dvec3(bounds.max) + glm::dvec3(bounds.min)) - eye_from_centre),
          glm::dmat3(rotation[0] * half.x, rotation[1] * half.y, rotation[2] * half.z)};
}

}  // namespace

void ChunksInView::find(const std::vector<NearBatch>& leaf_batches, const std::vector<std::uint32_t>& leaf_indices,
                        const glm::dvec3& centre, const ViewTransform& view, NearStatistics& statistics) {
  indices.clear();
  batches.clear();
  for (const NearBatch& batch : leaf_batches) {
    of_batch.clear();
    for (const MergedChunk& chunk : batch.chunks) {
      statistics.triangles_held += chunk.index_count / 3;
      const AffineBox box = in_camera(chunk.bounds, view.eye - centre, view.camera_from_scene);
      if (view.may_see(box)) of_batch.push_back({glm::dot(box.centre, box.centre), &chunk});
    }
    if (of_batch.empty()) continue;
    std::sort(of_batch.begin(), of_batch.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const std::size_t begin = indices.size();
    for (const auto& [distance, chunk] : of_batch) {
      const auto first = leaf_indices.begin() + chunk->first_index;
      indices.insert(indices.end(), first, first + chunk->index_count);
    }
    statistics.chunks_drawn += static_cast<std::uint32_t>(of_batch.size());
    batches.push_back({&batch, begin, indices.size() - begin, of_batch.front().first});
  }
  std::sort(batches.begin(), batches.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
  statistics.triangles = indices.size() / 3;
}

}  // namespace farfield::client

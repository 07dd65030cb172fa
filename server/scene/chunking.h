// SPDX-License-Identifier: Apache-2.0
// Clusters triangles into spatially compact groups: what becomes chunks.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace farfield {

struct TriangleItem {
  glm::vec3 centre;            // of the triangle's bounds
  std::uint32_t triangle = 0;  // any id; unique
};

/// Permutes `items` so that every cluster is a contiguous run of at most `max_size`, and returns where each run ends.
/// Based on: top-down median splits along the longest axis of the centres' bounds, as a balanced k-d tree; split
/// positions are multiples of max_size, so all clusters but one per call are full.
/// Deterministic for a given order of items. O(n log n), parallel over TBB.
std::vector<std::uint32_t> cluster_triangles(std::span<TriangleItem> items, std::uint32_t max_size);

}  // namespace farfield

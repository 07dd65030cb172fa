// SPDX-License-Identifier: Apache-2.0
// A mesh as the scene keeps it: triangles in chunk order, vertices grouped by chunk, attributes in the very codes that
// chunks carry, so that rays shade from the same numbers as the client.
//
// Layout: chunk k owns triangles [first_triangle, +triangle_count) and vertices [first_vertex, +vertex_count);
// vertices shared by two chunks are stored in both. Embree reads `positions` and `indices` in place.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "common/base/hash.h"
#include "common/geometry/chunk.h"
#include "common/math/box.h"
#include "server/scene/scene_plan.h"

namespace farfield {

struct StoredChunk {
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_vertex = 0, vertex_count = 0;
  glm::vec3 origin{0};  // mesh axes, on the position grid: ChunkVertex positions are relative to it
  ContentHash hash = 0;
};

/// What light on a vertex depends on, side by side: one cache line instead of two when rays shade.
struct VertexSurface {
  glm::i16vec2 normal;
  glm::u8vec4 colour;
};

struct StoredMesh {
  SurfaceState surface;
  std::vector<glm::vec3> positions;  // one more than there are vertices: Embree loads 16 bytes at a time
  std::vector<VertexSurface> surfaces;
  std::vector<glm::vec2> uvs;  // empty without a texture
  std::vector<std::uint32_t> indices;
  std::vector<StoredChunk> chunks;
  std::vector<std::uint32_t> chunk_at_block;  // the chunk that holds triangle 64·i

  std::size_t triangle_count() const { return indices.size() / 3; }
  std::size_t vertex_count() const { return positions.empty() ? 0 : positions.size() - 1; }
  /// Index into `chunks` of the chunk that holds a triangle. Requires: triangle < triangle_count().
  std::uint32_t chunk_of(std::uint32_t triangle) const {
    std::uint32_t chunk = chunk_at_block[triangle >> 6];
    while (triangle - chunks[chunk].first_triangle >= chunks[chunk].triangle_count) ++chunk;
    return chunk;
  }
};

/// The chunk in the form that is encoded. `texture`: content hash of the surface's texture, 0 for none.
Chunk extract_chunk(const StoredMesh& mesh, const StoredChunk& chunk, ContentHash texture);

/// Carries a plan out: drops triangles without area, clusters the rest, snaps and merges vertices. Deterministic.
/// `texture` goes into the chunks' hashes. Parallel over TBB; about 0.3 µs of thread time per triangle.
/// Errors: kLimitExceeded (more than 2³² - 1 vertices).
Result<StoredMesh> build_stored_mesh(const StoredMeshPlan& plan, ContentHash texture);

}  // namespace farfield

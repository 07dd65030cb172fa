// SPDX-License-Identifier: Apache-2.0
// From source meshes to a stored mesh: gather, cluster, then emit blocks of chunks in parallel and join them.
#include "server/scene/stored_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/scene/chunk_emitter.h"
#include "server/scene/chunking.h"

namespace farfield {
namespace {

// Smaller than the limit: what can be seen of a dense plant is a thin shell of it, and smaller clusters follow that shell
// more closely, so that the same geometry budget reaches farther and cells get larger.
constexpr std::uint32_t kChunkTriangles = 96;

constexpr std::size_t kChunksPerBlock = 256;
constexpr int kClassBits = 3;  // a size class spans a factor of 2³

struct Gathered {
  std::vector<TriangleItem> items;
  std::vector<std::size_t> class_ends;  // items are grouped by size class
};

// Large triangles are clustered apart from small ones: one floor triangle among bolts would stretch their chunk's
// bounds over the whole hall, and bounds decide what is near.
Gathered gather(const StoredMeshPlan& plan, const TriangleSources& sources) {
  Gathered result;
  result.items.resize(sources.triangle_count());
  std::vector<std::int8_t> classes(result.items.size());
  constexpr std::int8_t kDropped = std::numeric_limits<std::int8_t>::max();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, result.items.size(), 1 << 12),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      TriangleSources::Cursor cursor = sources.cursor();
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        classes[i] = kDropped;
                        glm::dvec3 corner[3];
                        if (!cursor.corners(i, corner)) continue;
                        const glm::dvec3 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
                        const glm::dvec3 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
                        const glm::dvec3 edge = high - low;
                        const double steps = std::max({edge.x, edge.y, edge.z}) / plan.step;
                        result.items[i] = {glm::vec3(0.5 * (low + high)), static_cast<std::uint32_t>(i)};
                        classes[i] = static_cast<std::int8_t>(std::ilogb(std::max(steps, 1.0)) / kClassBits);
                      }
                    });
  const auto class_of = [&](const TriangleItem& item) { return classes[item.triangle]; };
  // Dropped triangles still have triangle 0 in their item: compact by position first.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < result.items.size(); ++i)
    if (classes[i] != kDropped) result.items[kept++] = result.items[i];
  result.items.resize(kept);
  auto begin = result.items.begin();
  for (int size_class = 0; begin != result.items.end(); ++size_class) {
    const auto end = std::partition(begin, result.items.end(),
                                    [&](const TriangleItem& item) { return class_of(item) == size_class; });
    if (end != begin) result.class_ends.push_back(static_cast<std::size_t>(end - result.items.begin()));
    begin = end;
  }
  return result;
}

template <class T>
void append(std::vector<T>& all, std::size_t at, std::vector<T>& block) {
  std::copy(block.begin(), block.end(), all.begin() + static_cast<std::ptrdiff_t>(at));
  std::vector<T>().swap(block);  // blocks and the joined mesh should not both stay in memory
}

StoredMesh join(std::vector<StoredMesh>& blocks, const SurfaceState& surface) {
  std::vector<std::size_t> vertex_at(blocks.size() + 1, 0), triangle_at(blocks.size() + 1, 0),
      chunk_at(blocks.size() + 1, 0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    vertex_at[b + 1] = vertex_at[b] + blocks[b].positions.size();
    triangle_at[b + 1] = triangle_at[b] + blocks[b].indices.size() / 3;
    chunk_at[b + 1] = chunk_at[b] + blocks[b].chunks.size();
  }
  StoredMesh mesh;
  mesh.surface = surface;
  mesh.positions.resize(vertex_at.back() + 1);
  mesh.surfaces.resize(vertex_at.back());
  if (surface.texture >= 0) mesh.uvs.resize(vertex_at.back());
  mesh.indices.resize(3 * triangle_at.back());
  mesh.chunks.resize(chunk_at.back());
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    StoredMesh& block = blocks[b];
    for (std::uint32_t& index : block.indices) index += static_cast<std::uint32_t>(vertex_at[b]);
    for (StoredChunk& chunk : block.chunks) {
      chunk.first_vertex += static_cast<std::uint32_t>(vertex_at[b]);
      chunk.first_triangle += static_cast<std::uint32_t>(triangle_at[b]);
    }
    append(mesh.positions, vertex_at[b], block.positions);
    append(mesh.surfaces, vertex_at[b], block.surfaces);
    if (surface.texture >= 0) append(mesh.uvs, vertex_at[b], block.uvs);
    append(mesh.indices, 3 * triangle_at[b], block.indices);
    append(mesh.chunks, chunk_at[b], block.chunks);
  });
  mesh.chunk_at_block.resize(mesh.triangle_count() / 64 + 1);
  std::uint32_t chunk = 0;
  for (std::size_t block = 0; 64 * block < mesh.triangle_count(); ++block) {
    while (64 * block >= std::size_t{mesh.chunks[chunk].first_triangle} + mesh.chunks[chunk].triangle_count) ++chunk;
    mesh.chunk_at_block[block] = chunk;
  }
  return mesh;
}

}  // namespace

Result<StoredMesh> build_stored_mesh(const StoredMeshPlan& plan, ContentHash texture) {
  const TriangleSources sources(plan.sources);
  // Emission duplicates vertices at chunk borders, but never makes more than three per triangle.
  if (3 * sources.triangle_count() > std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorCode::kLimitExceeded,
                "{} triangles share one texture; at most {} fit one mesh: split the material", sources.triangle_count(),
                std::numeric_limits<std::uint32_t>::max() / 3);
  Gathered gathered = gather(plan, sources);
  const std::span<TriangleItem> items = gathered.items;
  std::vector<std::uint32_t> ends;
  std::size_t class_begin = 0;
  for (const std::size_t class_end : gathered.class_ends) {
    for (const std::uint32_t end :
         cluster_triangles(items.subspan(class_begin, class_end - class_begin), kChunkTriangles))
      ends.push_back(static_cast<std::uint32_t>(class_begin + end));
    class_begin = class_end;
  }
  std::vector<StoredMesh> blocks((ends.size() + kChunksPerBlock - 1) / kChunksPerBlock);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    ChunkEmitter emitter(plan, sources, texture, blocks[b]);
    const std::size_t last = std::min(ends.size(), (b + 1) * kChunksPerBlock);
    for (std::size_t c = b * kChunksPerBlock; c < last; ++c) {
      const std::size_t begin = c == 0 ? 0 : ends[c - 1];
      emitter.emit(items.subspan(begin, ends[c] - begin));
    }
  });
  gathered = {};
  return join(blocks, plan.surface);
}

Chunk extract_chunk(const StoredMesh& mesh, const StoredChunk& stored, ContentHash texture) {
  Chunk chunk;
  chunk.texture = texture;
  chunk.is_alpha_masked = mesh.surface.is_alpha_masked;
  chunk.alpha_cutoff = mesh.surface.alpha_cutoff;
  chunk.vertices.resize(stored.vertex_count);
  for (std::uint32_t i = 0; i < stored.vertex_count; ++i) {
    const std::uint32_t vertex = stored.first_vertex + i;
    // Both lie on the position grid, so the difference is exact.
    chunk.vertices[i] = {mesh.positions[vertex] - stored.origin, mesh.surfaces[vertex].normal,
                         mesh.uvs.empty() ? glm::vec2(0) : mesh.uvs[vertex], mesh.surfaces[vertex].colour};
  }
  chunk.indices.resize(3 * std::size_t{stored.triangle_count});
  for (std::size_t i = 0; i < chunk.indices.size(); ++i)
    chunk.indices[i] =
        static_cast<std::uint16_t>(mesh.indices[3 * std::size_t{stored.first_triangle} + i] - stored.first_vertex);
  return chunk;
}

}  // namespace farfield

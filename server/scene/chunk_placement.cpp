// SPDX-License-Identifier: Apache-2.0
#include "server/scene/chunk_placement.h"

#include <tbb/parallel_for.h>

#include <array>

namespace farfield {
namespace {

// Geometric normals of a chunk's triangles as placed, unit length.
std::size_t unit_normals(const StoredMesh& mesh, const StoredChunk& chunk, std::span<const glm::vec3> placed,
                         std::array<glm::vec3, kMaxChunkTriangles>& normals) {
  std::size_t count = 0;
  for (std::uint32_t t = 0; t < chunk.triangle_count; ++t) {
    const std::uint32_t* index = &mesh.indices[3 * (std::size_t{chunk.first_triangle} + t)];
    const glm::dvec3 a(placed[index[0] - chunk.first_vertex]);
    const glm::dvec3 normal = glm::cross(glm::dvec3(placed[index[1] - chunk.first_vertex]) - a,
                                         glm::dvec3(placed[index[2] - chunk.first_vertex]) - a);
    const double length = glm::length(normal);
    // A placement may flatten a triangle; it then faces nowhere and is never seen.
    if (length > 0) normals[count++] = glm::vec3(normal / length);
  }
  return count;
}

void set_cone(SceneChunk& placed, std::span<const glm::vec3> normals) {
  glm::vec3 sum{0};
  for (const glm::vec3& n : normals) sum += n;
  const float length = glm::length(sum);
  if (!(length > 0)) return;
  const glm::vec3 axis = sum / length;
  float cosine = 1;
  for (const glm::vec3& n : normals) cosine = std::min(cosine, glm::dot(n, axis));
  if (cosine <= 0) return;  // a half space or more: never wholly turned away
  placed.cone_axis = axis;
  placed.cone_cos = cosine;
}

SceneChunk place(const StoredMesh& mesh, const StoredChunk& chunk, const glm::mat4x3& scene_from_mesh) {
  SceneChunk placed;
  placed.hash = chunk.hash;
  placed.triangles = chunk.triangle_count;
  const glm::dmat4x3 m(scene_from_mesh);
  placed.scene_from_chunk = m;
  placed.scene_from_chunk[3] = m * glm::dvec4(glm::dvec3(chunk.origin), 1.0);
  std::array<glm::vec3, 3 * kMaxChunkTriangles> positions;
  for (std::uint32_t i = 0; i < chunk.vertex_count; ++i) {
    positions[i] = scene_from_mesh * glm::vec4(mesh.positions[chunk.first_vertex + i], 1.0f);
    placed.bounds.include(glm::dvec3(positions[i]));
  }
  std::array<glm::vec3, kMaxChunkTriangles> normals;
  const std::size_t count = unit_normals(mesh, chunk, {positions.data(), chunk.vertex_count}, normals);
  set_cone(placed, {normals.data(), count});
  return placed;
}

}  // namespace

PlacedChunks place_chunks(std::span<const StoredMesh> meshes, std::span<ScenePart> parts) {
  PlacedChunks result;
  std::uint32_t stored = 0;
  for (const StoredMesh& mesh : meshes) {
    result.first_of_mesh.push_back(stored);
    stored += static_cast<std::uint32_t>(mesh.chunks.size());
  }
  std::size_t total = 0;
  for (const ScenePart& part : parts) {
    result.first_of_part.push_back(static_cast<std::uint32_t>(total));
    total += meshes[part.mesh].chunks.size();
  }
  result.chunks.resize(total);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    const StoredMesh& mesh = meshes[parts[p].mesh];
    tbb::parallel_for(std::size_t{0}, mesh.chunks.size(), [&](std::size_t c) {
      SceneChunk& placed = result.chunks[result.first_of_part[p] + c];
      placed = place(mesh, mesh.chunks[c], parts[p].scene_from_mesh);
      placed.part = static_cast<std::uint32_t>(p);
      placed.stored_chunk = result.first_of_mesh[parts[p].mesh] + static_cast<std::uint32_t>(c);
    });
    Box bounds;
    for (std::size_t c = 0; c < mesh.chunks.size(); ++c)
      bounds.include(result.chunks[result.first_of_part[p] + c].bounds);
    parts[p].bounds = bounds;
  });
  return result;
}

}  // namespace farfield

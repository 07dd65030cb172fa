// SPDX-License-Identifier: Apache-2.0
#include "server/visibility/visible_chunks.h"

#include <algorithm>

#include "server/visibility/sphere_rays.h"

namespace farfield {

bool faces_away(const SceneChunk& chunk, const Box& viewpoints) {
  if (chunk.cone_cos <= 0) return false;
  // A triangle with normal n at point q faces away from p if n·(p - q) < 0. Over the cone of normals the left side is
  // at most |p - q|·cos(angle(axis, p - q) - cone angle); bound it over both boxes by their spheres.
  const glm::dvec3 between = viewpoints.center() - chunk.bounds.center();
  const double reach = 0.5 * (glm::length(viewpoints.extent()) + glm::length(chunk.bounds.extent()));
  const double distance = glm::length(between);
  if (distance <= reach) return false;
  const double along = glm::dot(between, glm::dvec3(chunk.cone_axis)) / distance;
  const double cone_sin = std::sqrt(std::max(0.0, 1.0 - double{chunk.cone_cos} * chunk.cone_cos));
  const double across = std::sqrt(std::max(0.0, 1.0 - along * along));
  return distance * (along * chunk.cone_cos + across * cone_sin) + reach < 0;
}

void add_thin_chunks(const Scene& scene, const std::vector<std::uint32_t>& candidates,
                     const std::vector<glm::dvec3>& viewpoints, ChunkSet& visible) {
  constexpr int kPoints = 16;
  for (const std::uint32_t index : candidates) {
    if (visible.contains(index)) continue;
    const SceneChunk& chunk = scene.chunks()[index];
    const Chunk geometry = scene.chunk_geometry(index);
    const std::size_t triangles = geometry.indices.size() / 3;
    if (triangles == 0) continue;
    glm::dvec3 points[kPoints];
    for (int k = 0; k < kPoints; ++k) {
      const std::size_t triangle = triangles * static_cast<std::size_t>(k) / kPoints;
      glm::dvec3 sum(0);
      for (int c = 0; c < 3; ++c) sum += glm::dvec3(geometry.vertices[geometry.indices[3 * triangle + c]].position);
      points[k] = glm::dvec3(chunk.scene_from_chunk * glm::dvec4(sum / 3.0, 1.0));
    }
    for (const glm::dvec3& viewpoint : viewpoints) {
      RayPacket rays;
      for (int k = 0; k < kPoints; ++k) {
        set_ray(rays, k, viewpoint, points[k] - viewpoint, {});
        rays.far[k] = 0.999f;  // anything nearer than the last thousandth of the way hides the point
      }
      if (scene.occluded(rays) != 0xffffu) {
        visible.insert(index);
        break;
      }
    }
  }
}

}  // namespace farfield

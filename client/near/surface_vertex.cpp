// SPDX-License-Identifier: Apache-2.0
#include "client/near/surface_vertex.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/shading/shading.h"

namespace farfield::client {
namespace {

/// det(m)·inverse(transpose(m)): carries normals, also where a placement flattens (no division by det).
glm::mat3 normal_matrix(const glm::mat4x3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

std::uint16_t code_radiance(float linear) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(linear, 0.0f, 1.0f) * 65535.0f));
}

}  // namespace

SurfaceBounds append_surface(const Chunk& chunk, const glm::mat4x3& frame_from_chunk,
                             std::vector<SurfaceVertex>& vertices, std::vector<std::uint32_t>& indices) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  const glm::mat3 frame_normal_from_chunk = normal_matrix(frame_from_chunk);
  SurfaceBounds bounds{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
  for (const ChunkVertex& v : chunk.vertices) {
    const glm::vec3 position = frame_from_chunk * glm::vec4(v.position, 1.0f);
    glm::vec3 normal = frame_normal_from_chunk * decode_normal(v.normal);
    const float length = glm::length(normal);
    // A placement that flattens the surface to nothing leaves no normal; such a triangle has no pixels either.
    normal = length > 0 ? normal / length : glm::vec3(0, 1, 0);
    const glm::vec3 radiance = vertex_radiance(normal, v.colour);
    vertices.push_back(
        {position, {code_radiance(radiance.r), code_radiance(radiance.g), code_radiance(radiance.b), 0}, v.uv});
    bounds.min = glm::min(bounds.min, position), bounds.max = glm::max(bounds.max, position);
  }
  const std::size_t count = chunk.vertices.size();
  for (std::size_t i = 0; i + 2 < chunk.indices.size(); i += 3) {
    const std::array<std::uint32_t, 3> t{chunk.indices[i], chunk.indices[i + 1], chunk.indices[i + 2]};
    if (t[0] >= count || t[1] >= count || t[2] >= count) continue;
    for (const std::uint32_t index : t) indices.push_back(first + index);
  }
  return bounds;
}

}  // namespace farfield::client

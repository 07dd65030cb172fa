// SPDX-License-Identifier: Apache-2.0
// Scene geometry as the vertex shader reads it: placed, with its light baked by the system's one shading function, so
// that client, truth and impostors interpolate the same numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <vector>

#include "common/geometry/chunk.h"

namespace farfield::client {

struct SurfaceVertex {
  glm::vec3 position;     // metres relative to the frame's centre
  glm::u16vec4 radiance;  // linear, 65535 is 1; w unused
  glm::vec2 uv;
};
static_assert(sizeof(SurfaceVertex) == 28);

/// Axis-aligned, in metres relative to the frame's centre.
struct SurfaceBounds {
  glm::vec3 min{0}, max{0};
};

/// Appends a chunk's vertices, placed by `frame_from_chunk`, and its triangles as absolute vertex indices.
/// Triangles that name a vertex the chunk does not have are left out. Returns: the placed chunk's bounds.
SurfaceBounds append_surface(const Chunk& chunk, const glm::mat4x3& frame_from_chunk,
                             std::vector<SurfaceVertex>& vertices, std::vector<std::uint32_t>& indices);

}  // namespace farfield::client

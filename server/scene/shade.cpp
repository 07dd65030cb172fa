// SPDX-License-Identifier: Apache-2.0
// Scene::shade: the radiance of what a packet hit, by the formula of common/shading/shading.h.
//
// Neighbouring lanes mostly hit the same triangle, so what depends on the triangle alone is kept from lane to lane.
#include <cmath>

#include "common/shading/shading.h"
#include "server/scene/scene_state.h"

namespace farfield {
namespace {

// Grazing rays have endless footprints; beyond this inclination the filter would blur across the line of sight more
// than it must.
constexpr float kLeastCosine = 1.0f / 16.0f;

// Everything about a hit triangle that shading needs, edges as differences from vertex 0.
struct TriangleLight {
  glm::vec3 radiance{0}, radiance_u{0}, radiance_v{0};
  glm::vec2 uv{0}, uv_u{0}, uv_v{0};
  float texels = 0;              // twice the triangle's area in texels of level 0
  std::int32_t texture = -1;     // -1: none, and the two lines above mean nothing
};

}  // namespace

void Scene::shade(const RayPacket& rays, const HitPacket& hits, float pixel_angle, float* rgb) const {
  const State& state = *state_;
  const std::array<float, 256>& linear = state.textures.linear_table();
  TriangleLight light;
  std::uint32_t part = kNoHit, primitive = kNoHit;

  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!(rays.active >> lane & 1u) || hits.part[lane] == kNoHit) continue;
    if (hits.part[lane] != part || hits.primitive[lane] != primitive) {
      part = hits.part[lane];
      primitive = hits.primitive[lane];
      const StoredMesh& mesh = state.meshes[state.parts[part].mesh];
      const std::uint32_t* index = &mesh.indices[3 * std::size_t{primitive}];
      glm::vec3 vertex[3];
      for (int k = 0; k < 3; ++k) {
        glm::vec3 normal = decode_normal(mesh.normals[index[k]]);
        if (part >= state.flattened_parts) normal = glm::normalize(state.light_from_mesh[part] * normal);
        const glm::u8vec4 colour = mesh.colours[index[k]];
        vertex[k] = vertex_light(normal) * glm::vec3(linear[colour.r], linear[colour.g], linear[colour.b]);
      }
      light.radiance = vertex[0];
      light.radiance_u = vertex[1] - vertex[0];
      light.radiance_v = vertex[2] - vertex[0];
      light.texture = mesh.surface.texture;
      if (light.texture >= 0) {
        light.uv = mesh.uvs[index[0]];
        light.uv_u = mesh.uvs[index[1]] - light.uv;
        light.uv_v = mesh.uvs[index[2]] - light.uv;
        const float uv_area = std::abs(light.uv_u.x * light.uv_v.y - light.uv_u.y * light.uv_v.x);
        light.texels = uv_area * state.textures.texel_count(static_cast<std::uint32_t>(light.texture));
      }
    }
    const float u = hits.u[lane], v = hits.v[lane];
    glm::vec3 radiance = light.radiance + u * light.radiance_u + v * light.radiance_v;
    if (light.texture >= 0) {
      const glm::vec3 normal(hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]);
      const glm::vec3 direction(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
      const float length2 = glm::dot(direction, direction);
      const float width = pixel_angle * hits.distance[lane];  // × |direction|, squared below
      const float area = glm::length(normal);                 // twice the triangle's, in square metres
      const float cosine = std::abs(glm::dot(normal, direction)) / (area * std::sqrt(length2));
      const float footprint = width * width * length2 / std::max(cosine, kLeastCosine);
      radiance *= state.textures.sample(static_cast<std::uint32_t>(light.texture), light.uv + u * light.uv_u + v * light.uv_v,
                                        mip_level(footprint * light.texels / area));
    }
    rgb[3 * lane] = radiance.r;
    rgb[3 * lane + 1] = radiance.g;
    rgb[3 * lane + 2] = radiance.b;
  }
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Scene::shade: the radiance of what a packet hit, by the formula of common/shading/shading.h.
//
// The lanes of a packet mostly share a few triangles, so the lanes are taken triangle by triangle.
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "common/shading/shading.h"
#include "server/scene/scene_state.h"

namespace farfield {
namespace {

// Grazing rays have endless footprints; beyond this inclination the filter would blur across the line of sight more
// than it must.
constexpr float kLeastCosine = 1.0f / 16.0f;

// A value on a triangle: at vertex 0, and its change towards vertices 1 and 2.
template <class T>
struct OnTriangle {
  T at0, along_u, along_v;
  OnTriangle(const T& a, const T& b, const T& c) : at0(a), along_u(b - a), along_v(c - a) {}
  T at(float u, float v) const { return at0 + u * along_u + v * along_v; }
};

std::uint32_t lanes_of(const HitPacket& hits, std::uint32_t part, std::uint32_t primitive) {
  std::uint32_t mask = 0;
  for (int lane = 0; lane < kPacketSize; ++lane)
    mask |= static_cast<std::uint32_t>((hits.part[lane] == part) & (hits.primitive[lane] == primitive)) << lane;
  return mask;
}

std::uint32_t lanes_of_misses(const HitPacket& hits) {
  std::uint32_t mask = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) mask |= static_cast<std::uint32_t>(hits.part[lane] == kNoHit) << lane;
  return mask;
}

// The footprint's area on the surface in square metres, divided by the triangle's area doubled.
float relative_footprint(const RayPacket& rays, const HitPacket& hits, int lane, float pixel_angle) {
  const glm::vec3 normal(hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]);
  const glm::vec3 direction(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
  const float length2 = glm::dot(direction, direction);
  const float doubled_area = glm::length(normal);
  const float width = pixel_angle * hits.distance[lane];  // × |direction|, squared below
  const float cosine = std::abs(glm::dot(normal, direction)) / (doubled_area * std::sqrt(length2));
  return width * width * length2 / (std::max(cosine, kLeastCosine) * doubled_area);
}

// Side by side, one for each of four look-ups.
typedef double F64x4 __attribute__((vector_size(32)));

// Where rays turned a little from one that meets a triangle's plane meet it, in barycentric terms. In double: the square of a
// small triangle's doubled area is not a float.
class TurnedRays {
 public:
  /// By half of `across` and of `down`, either way.
  TurnedRays(const glm::vec3& edge_u, const glm::vec3& edge_v, const glm::vec3& across, const glm::vec3& down)
      : normal_(glm::cross(glm::dvec3(edge_u), glm::dvec3(edge_v))) {
    const double scale = 1.0 / glm::dot(normal_, normal_);
    per_u_ = glm::cross(glm::dvec3(edge_v), normal_) * scale;
    per_v_ = glm::cross(normal_, glm::dvec3(edge_u)) * scale;
    const auto along = [&](const glm::dvec3& axis, F64x4& turned) {
      turned = 0.5 * glm::dot(axis, glm::dvec3(across)) * F64x4{-1, 1, -1, 1} + 0.5 * glm::dot(axis, glm::dvec3(down)) * F64x4{-1, -1, 1, 1};
    };
    along(normal_, turn_normal_), along(per_u_, turn_u_), along(per_v_, turn_v_);
  }
  /// How much (u, v) changes for each. Zero where that leads more than four triangles away, or the triangle is none: a texture
  /// need not go on there as it does here.
  std::array<glm::vec2, 4> changes(const glm::dvec3& direction, double distance) const {
    const double facing = glm::dot(normal_, direction), u = glm::dot(per_u_, direction), v = glm::dot(per_v_, direction);
    const F64x4 turned = facing + turn_normal_;
    // Near the horizon of a plane the footprint has no end: four times as far at most.
    F64x4 ratio = facing / turned;
    ratio = (turned * facing > 0) & (ratio < 4) ? ratio : F64x4{4, 4, 4, 4};
    const F64x4 du = distance * (ratio * (u + turn_u_) - u), dv = distance * (ratio * (v + turn_v_) - v);
    std::array<glm::vec2, 4> result;
    for (int k = 0; k < 4; ++k)
      result[static_cast<std::size_t>(k)] = std::abs(du[k]) <= 4 && std::abs(dv[k]) <= 4 ? glm::vec2(du[k], dv[k]) : glm::vec2(0);
    return result;
  }

 private:
  glm::dvec3 normal_, per_u_, per_v_;
  F64x4 turn_normal_, turn_u_, turn_v_;  // products of the turns with these
};

}  // namespace

struct Scene::FineLookups {
  glm::vec3 across, down;
};

void Scene::shade(const RayPacket& rays, const HitPacket& hits, float pixel_angle, float* rgb) const {
  shade(rays, hits, pixel_angle, nullptr, rgb);
}

void Scene::shade_finely(const RayPacket& rays, const HitPacket& hits, float pixel_angle, const glm::vec3& across,
                         const glm::vec3& down, float* rgb) const {
  const FineLookups fine{across, down};
  shade(rays, hits, 0.5f * pixel_angle, &fine, rgb);
}

void Scene::shade(const RayPacket& rays, const HitPacket& hits, float pixel_angle, const FineLookups* fine, float* rgb) const {
  const State& state = *state_;
  const std::array<float, 256>& linear = state.textures.linear_table();
  std::uint32_t pending = rays.active & 0xffffu & ~lanes_of_misses(hits);
  while (pending != 0) {
    const int first = std::countr_zero(pending);
    const std::uint32_t part = hits.part[first], primitive = hits.primitive[first];
    std::uint32_t lanes = pending & lanes_of(hits, part, primitive);
    pending &= ~lanes;

    const StoredMesh& mesh = state.meshes[state.parts[part].mesh];
    const std::uint32_t* index = &mesh.indices[3 * std::size_t{primitive}];
    glm::vec3 vertex[3];
    for (int k = 0; k < 3; ++k) {
      const VertexSurface& surface = mesh.surfaces[index[k]];
      glm::vec3 normal = decode_normal(surface.normal);
      if (part >= state.flattened_parts) normal = glm::normalize(state.light_from_mesh[part] * normal);
      vertex[k] = vertex_light(normal) *
                  glm::vec3(linear[surface.colour.r], linear[surface.colour.g], linear[surface.colour.b]);
    }
    const OnTriangle<glm::vec3> radiance(vertex[0], vertex[1], vertex[2]);
    if (mesh.surface.texture < 0) {
      for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        const glm::vec3 value = radiance.at(hits.u[lane], hits.v[lane]);
        for (int c = 0; c < 3; ++c) rgb[3 * lane + c] = value[c];
      }
      continue;
    }
    const auto texture = static_cast<std::uint32_t>(mesh.surface.texture);
    const OnTriangle<glm::vec2> uv(mesh.uvs[index[0]], mesh.uvs[index[1]], mesh.uvs[index[2]]);
    const float doubled_area = std::abs(uv.along_u.x * uv.along_v.y - uv.along_u.y * uv.along_v.x);
    const float texels = doubled_area * state.textures.texel_count(texture);
    const auto edge = [&](int k) {
      const glm::vec3 in_mesh = mesh.positions[index[k]] - mesh.positions[index[0]];
      return part < state.flattened_parts ? in_mesh : glm::mat3(state.parts[part].scene_from_mesh) * in_mesh;
    };
    std::optional<TurnedRays> turned;
    if (fine) turned.emplace(edge(1), edge(2), fine->across, fine->down);
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const float u = hits.u[lane], v = hits.v[lane];
      const float mip = mip_level(relative_footprint(rays, hits, lane, pixel_angle) * texels);
      glm::vec3 albedo;
      if (turned) {
        const glm::vec3 direction(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
        std::array<glm::vec2, 4> places = turned->changes(direction, hits.distance[lane]);
        for (glm::vec2& place : places) place = uv.at(u + place.x, v + place.y);
        albedo = state.textures.mean_of_four(texture, places, mip);
      } else {
        albedo = state.textures.sample(texture, uv.at(u, v), mip);
      }
      const glm::vec3 value = radiance.at(u, v) * albedo;
      for (int c = 0; c < 3; ++c) rgb[3 * lane + c] = value[c];
    }
  }
}

}  // namespace farfield

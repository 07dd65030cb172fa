// SPDX-License-Identifier: Apache-2.0
// Small models the scene tests build by hand.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace farfield::test {

inline void add_triangle(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  for (const glm::vec3& p : {a, b, c}) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(p);
  }
}

inline Mesh random_triangles(int count, unsigned seed, float size = 0.3f) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 a = 4.0f * point();
    add_triangle(mesh, a, a + size * (point() - 0.5f), a + size * (point() - 0.5f));
  }
  return mesh;
}

/// Unit sphere, shared vertices, smooth normals.
inline Mesh sphere(int rings) {
  Mesh mesh;
  const int segments = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const double polar = M_PI * r / rings, around = 2 * M_PI * s / segments;
      mesh.positions.emplace_back(std::sin(polar) * std::cos(around), std::cos(polar),
                                  std::sin(polar) * std::sin(around));
      if (r == 0 || r == rings) mesh.positions.back() = glm::vec3(0, r == 0 ? 1 : -1, 0);
      mesh.normals.push_back(glm::normalize(mesh.positions.back()));
    }
  const auto at = [&](int r, int s) { return static_cast<std::uint32_t>(r * segments + s % segments); };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      if (r > 0) mesh.indices.insert(mesh.indices.end(), {at(r, s), at(r, s + 1), at(r + 1, s)});
      if (r + 1 < rings) mesh.indices.insert(mesh.indices.end(), {at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
    }
  return mesh;
}

/// The square [0, 1]² at z = 0 with uv = (x, y)·repeat.
inline Mesh square(float repeat = 1) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const glm::vec3& p : mesh.positions) mesh.uvs.emplace_back(p.x * repeat, p.y * repeat);
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

inline Model model_of(Mesh mesh, const glm::dmat4& world_from_mesh = glm::dmat4(1)) {
  Model model;
  model.name = "test";
  model.materials.emplace_back();
  model.meshes.push_back(std::move(mesh));
  model.instances.push_back({0, world_from_mesh});
  return model;
}

inline std::shared_ptr<const Scene> build(Model model) {
  auto scene = Scene::build(std::move(model));
  if (!scene) throw std::runtime_error(scene.error().message);
  return *scene;
}

inline RayPacket packet_from(const glm::vec3& origin) {
  RayPacket rays{};
  for (int i = 0; i < kPacketSize; ++i) {
    rays.origin_x[i] = origin.x;
    rays.origin_y[i] = origin.y;
    rays.origin_z[i] = origin.z;
    rays.near[i] = 0;
    rays.far[i] = std::numeric_limits<float>::infinity();
  }
  rays.active = 0xffff;
  return rays;
}

inline void aim(RayPacket& rays, int lane, const glm::vec3& direction) {
  rays.direction_x[lane] = direction.x;
  rays.direction_y[lane] = direction.y;
  rays.direction_z[lane] = direction.z;
}

}  // namespace farfield::test

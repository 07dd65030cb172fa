// SPDX-License-Identifier: Apache-2.0
#include "server/model/double_mesh.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

namespace farfield {
namespace {

Box usable_bounds(const DoubleMesh& mesh) {
  Box box;
  for (const glm::dvec3& p : mesh.positions) {
    if (is_usable_position(p)) box.include(p);
  }
  return box;
}

/// Zero if the box holds the origin or lies near it; else its centre in whole units, where they are small beside it.
glm::dvec3 offset_for(const Box& box) {
  if (box.is_empty()) return glm::dvec3(0);
  glm::dvec3 offset(0);
  for (int a = 0; a < 3; ++a) {
    const double centre = box.center()[a], half = 0.5 * box.extent()[a];
    if (std::abs(centre) <= 2 * half) continue;
    offset[a] = half >= 1 ? std::round(centre) : centre;
  }
  return offset;
}

// Half of the extent at which a float's spacing reaches 2^-10: 2^13 with 24 significant bits.
constexpr double kSharedOffsetHalfExtent = 8192;

}  // namespace

void store_double_meshes(std::vector<DoubleMesh> meshes, Model& model) {
  Box all;
  for (const DoubleMesh& mesh : meshes) all.include(usable_bounds(mesh));
  const glm::dvec3 shared_offset = offset_for(all);
  const glm::dvec3 reach = glm::max(glm::abs(all.max - shared_offset), glm::abs(all.min - shared_offset));
  const bool is_shared = all.is_empty() || std::max({reach.x, reach.y, reach.z}) <= kSharedOffsetHalfExtent;

  for (DoubleMesh& source : meshes) {
    const glm::dvec3 offset = is_shared ? shared_offset : offset_for(usable_bounds(source));
    Mesh mesh;
    mesh.name = std::move(source.name);
    mesh.material = source.material;
    mesh.positions.reserve(source.positions.size());
    for (const glm::dvec3& p : source.positions) {
      mesh.positions.push_back(is_usable_position(p) ? glm::vec3(p - offset)
                                                     : glm::vec3(std::numeric_limits<float>::quiet_NaN()));
    }
    source.positions = {};
    mesh.normals = std::move(source.normals);
    mesh.uvs = std::move(source.uvs);
    mesh.colours = std::move(source.colours);
    mesh.indices = std::move(source.indices);
    model.instances.push_back({static_cast<int>(model.meshes.size()), glm::translate(glm::dmat4(1), offset)});
    model.meshes.push_back(std::move(mesh));
  }
}

}  // namespace farfield

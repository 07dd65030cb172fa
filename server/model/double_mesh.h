// SPDX-License-Identifier: Apache-2.0
// Meshes as read, in double, and their way into a Model without loss: an offset is subtracted before a float is stored.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "server/model/model.h"

namespace farfield {

/// One material's triangles in file coordinates. Per-vertex arrays are empty or as long as `positions`.
struct DoubleMesh {
  std::string name;
  int material = 0;
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs;
  std::vector<glm::u8vec4> colours;
  std::vector<std::uint32_t> indices;
};

/// Coordinates beyond this, in file units, are mistakes, not places: the Earth is 1.3e7 m across, and millimetres
/// of a national grid stay below 1e9 as well.
inline constexpr double kMaxCoordinate = 1e9;
inline bool is_usable_position(const glm::dvec3& p) {
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate && std::abs(p.z) <= kMaxCoordinate;
}

/// Moves the meshes into `model`, each with one instance whose translation is the offset.
///
/// All meshes share one offset, so that vertices they share stay exactly shared; it is zero where the meshes surround
/// the origin, and the rounded centre of their bounds otherwise. Only where floats around the common centre would be
/// coarser than 2^-10 file units (extents beyond 16 km in metres) does every mesh take its own offset.
/// Unusable positions are stored as NaN, for clean_model() to drop and count.
void store_double_meshes(std::vector<DoubleMesh> meshes, Model& model);

}  // namespace farfield

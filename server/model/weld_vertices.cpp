// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstring>
#include <limits>

#include "common/base/hash.h"
#include "server/model/clean_model.h"

namespace farfield {
namespace {

/// Every attribute of one vertex, side by side without padding.
struct VertexKey {
  glm::vec3 position{0}, normal{0};
  glm::vec2 uv{0};
  glm::u8vec4 colour{0};
};
static_assert(sizeof(VertexKey) == 36);

VertexKey key_of(const Mesh& mesh, std::size_t i) {
  VertexKey key;
  key.position = mesh.positions[i];
  if (!mesh.normals.empty()) key.normal = mesh.normals[i];
  if (!mesh.uvs.empty()) key.uv = mesh.uvs[i];
  if (!mesh.colours.empty()) key.colour = mesh.colours[i];
  return key;
}

}  // namespace

void weld_vertices(Mesh& mesh) {
  constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();
  const std::size_t slots = std::bit_ceil(2 * mesh.positions.size() + 1);  // at most half full: short probes
  std::vector<std::uint32_t> table(slots, kEmpty);
  std::vector<std::uint32_t> new_of_old(mesh.positions.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const VertexKey key = key_of(mesh, i);
    std::size_t slot = hash_value(key) & (slots - 1);
    while (table[slot] != kEmpty) {
      const VertexKey other = key_of(mesh, table[slot]);
      if (std::memcmp(&key, &other, sizeof(key)) == 0) break;
      slot = (slot + 1) & (slots - 1);
    }
    if (table[slot] == kEmpty) {
      table[slot] = kept;
      mesh.positions[kept] = key.position;
      if (!mesh.normals.empty()) mesh.normals[kept] = key.normal;
      if (!mesh.uvs.empty()) mesh.uvs[kept] = key.uv;
      if (!mesh.colours.empty()) mesh.colours[kept] = key.colour;
      ++kept;
    }
    new_of_old[i] = table[slot];
  }
  mesh.positions.resize(kept);
  if (!mesh.normals.empty()) mesh.normals.resize(kept);
  if (!mesh.uvs.empty()) mesh.uvs.resize(kept);
  if (!mesh.colours.empty()) mesh.colours.resize(kept);
  for (std::uint32_t& i : mesh.indices) {
    if (i < new_of_old.size()) i = new_of_old[i];
  }
}

}  // namespace farfield

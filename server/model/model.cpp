// SPDX-License-Identifier: Apache-2.0
#include "server/model/model.h"

namespace farfield {

std::size_t Model::drawn_triangles() const {
  std::size_t triangles = 0;
  for (const MeshInstance& instance : instances)
    triangles += meshes[static_cast<std::size_t>(instance.mesh)].indices.size() / 3;
  return triangles;
}

Box Model::bounds() const {
  Box box;
  for (const MeshInstance& instance : instances) {
    for (const glm::vec3& position : meshes[static_cast<std::size_t>(instance.mesh)].positions) {
      box.include(glm::dvec3(instance.world_from_mesh * glm::dvec4(position, 1.0)));
    }
  }
  return box;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// What every reader of models promises about the models it returns.
#pragma once

#include "server/model/model.h"
#include "tests/fuzz/require.h"

namespace farfield::fuzz {

/// All numbers in range; per-vertex arrays empty or as long as positions. With `has_checked_indices` also that every
/// index names a vertex (read_model_stream() leaves that to clean_model()).
inline void require_usable(const Model& model, bool has_checked_indices) {
  for (const Material& material : model.materials) {
    require(material.texture >= -1 && material.texture < static_cast<int>(model.textures.size()), "textures exist");
  }
  for (const TextureImage& texture : model.textures) {
    require(texture.width >= 0 && texture.height >= 0 &&
                texture.rgba.size() == std::size_t{4} * texture.width * texture.height,
            "textures have four bytes per texel");
  }
  for (const Mesh& mesh : model.meshes) {
    const std::size_t count = mesh.positions.size();
    const auto fits = [&](std::size_t size) { return size == 0 || size == count; };
    require(fits(mesh.normals.size()) && fits(mesh.uvs.size()) && fits(mesh.colours.size()),
            "per-vertex arrays are empty or as long as positions");
    require(mesh.indices.size() % 3 == 0, "three indices per triangle");
    require(mesh.material >= 0 && mesh.material < static_cast<int>(model.materials.size()), "materials exist");
    for (const std::uint32_t index : mesh.indices) require(!has_checked_indices || index < count, "indices name vertices");
  }
  for (const MeshInstance& instance : model.instances) {
    require(instance.mesh >= 0 && instance.mesh < static_cast<int>(model.meshes.size()), "instances place meshes");
  }
}

}  // namespace farfield::fuzz

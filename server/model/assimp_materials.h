// SPDX-License-Identifier: Apache-2.0
// Materials and textures of an Assimp scene, as Farfield knows them. For the Assimp reader only.
#pragma once

#include <filesystem>
#include <vector>

#include "server/model/model.h"

struct aiScene;

namespace farfield {

/// Which of Assimp's texture-coordinate sets a material's texture uses, by material.
using UvChannels = std::vector<unsigned>;

/// Appends one Material per Assimp material (at least one), in the same order, and their textures to `model`.
/// glTF factors are linear and are coded as sRGB here; other formats' colours are sRGB already. `folder`: where
/// textures outside the file are looked for.
UvChannels add_assimp_materials(const aiScene& scene, bool is_gltf, const std::filesystem::path& folder, Model& model);

}  // namespace farfield

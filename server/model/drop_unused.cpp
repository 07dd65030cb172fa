// SPDX-License-Identifier: Apache-2.0
#include "server/model/clean_model.h"

namespace farfield {
namespace {

/// Keeps the used items in their order. Returns: new numbers by old ones, -1 for those that went.
template <class T>
std::vector<int> compact(std::vector<T>& items, const std::vector<bool>& is_used) {
  std::vector<int> new_of_old(items.size(), -1);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!is_used[i]) continue;
    new_of_old[i] = static_cast<int>(kept);
    if (kept != i) items[kept] = std::move(items[i]);
    ++kept;
  }
  items.resize(kept);
  return new_of_old;
}

}  // namespace

void drop_empty_meshes(Model& model) {
  std::vector<bool> is_used(model.meshes.size(), false);
  for (const MeshInstance& instance : model.instances) is_used[static_cast<std::size_t>(instance.mesh)] = true;
  for (std::size_t i = 0; i < model.meshes.size(); ++i) is_used[i] = is_used[i] && !model.meshes[i].indices.empty();
  const std::vector<int> new_of_old = compact(model.meshes, is_used);
  std::erase_if(model.instances, [&](const MeshInstance& i) { return new_of_old[static_cast<std::size_t>(i.mesh)] < 0; });
  for (MeshInstance& instance : model.instances) instance.mesh = new_of_old[static_cast<std::size_t>(instance.mesh)];
}

void drop_unused_materials(Model& model) {
  std::vector<bool> is_used(model.materials.size(), false);
  for (const Mesh& mesh : model.meshes) is_used[static_cast<std::size_t>(mesh.material)] = true;
  const std::vector<int> new_material = compact(model.materials, is_used);
  for (Mesh& mesh : model.meshes) mesh.material = new_material[static_cast<std::size_t>(mesh.material)];

  std::vector<bool> is_drawn(model.textures.size(), false);
  for (const Material& material : model.materials) {
    if (material.texture >= 0) is_drawn[static_cast<std::size_t>(material.texture)] = true;
  }
  const std::vector<int> new_texture = compact(model.textures, is_drawn);
  for (Material& material : model.materials) {
    if (material.texture >= 0) material.texture = new_texture[static_cast<std::size_t>(material.texture)];
  }
}

}  // namespace farfield

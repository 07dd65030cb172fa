// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <tuple>

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

/// Number of the first material that looks like each one.
std::vector<int> first_alike(const std::vector<Material>& materials) {
  std::map<std::tuple<std::uint32_t, int, bool, float>, int> first;
  std::vector<int> result;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Material& m = materials[i];
    const std::uint32_t colour =
        static_cast<std::uint32_t>(m.base_colour.r) | static_cast<std::uint32_t>(m.base_colour.g) << 8 |
        static_cast<std::uint32_t>(m.base_colour.b) << 16 | static_cast<std::uint32_t>(m.base_colour.a) << 24;
    const float cutoff = m.is_alpha_masked ? m.alpha_cutoff : 0.0f;
    result.push_back(
        first.try_emplace({colour, m.texture, m.is_alpha_masked, cutoff}, static_cast<int>(i)).first->second);
  }
  return result;
}

}  // namespace

void drop_empty_meshes(Model& model) {
  std::vector<bool> is_used(model.meshes.size(), false);
  for (const MeshInstance& instance : model.instances) is_used[static_cast<std::size_t>(instance.mesh)] = true;
  for (std::size_t i = 0; i < model.meshes.size(); ++i) is_used[i] = is_used[i] && !model.meshes[i].indices.empty();
  const std::vector<int> new_of_old = compact(model.meshes, is_used);
  std::erase_if(model.instances,
                [&](const MeshInstance& i) { return new_of_old[static_cast<std::size_t>(i.mesh)] < 0; });
  for (MeshInstance& instance : model.instances) instance.mesh = new_of_old[static_cast<std::size_t>(instance.mesh)];
}

void drop_unused_materials(Model& model) {
  const std::vector<int> alike = first_alike(model.materials);
  std::vector<bool> is_used(model.materials.size(), false);
  for (Mesh& mesh : model.meshes) {
    mesh.material = alike[static_cast<std::size_t>(mesh.material)];
    is_used[static_cast<std::size_t>(mesh.material)] = true;
  }
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

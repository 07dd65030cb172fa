// SPDX-License-Identifier: Apache-2.0
#include "server/model/transparency.h"

#include <fmt/format.h>

#include "server/model/clean_model.h"

namespace farfield {
namespace {

struct Holes {
  bool some = false, all = true;
};

Holes holes_of(const TextureImage& texture, float cutoff) {
  Holes holes;
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
    const bool is_hole = static_cast<float>(texture.rgba[i]) / 255.0f < cutoff;
    holes.some = holes.some || is_hole;
    holes.all = holes.all && is_hole;
  }
  return holes;
}

/// Returns: false if the material is absent whatever its vertex colours say.
bool settle_material(Material& material, const Model& model) {
  const float alpha = static_cast<float>(material.base_colour.a) / 255.0f;
  material.base_colour.a = 255;
  if (!material.is_alpha_masked) return true;
  if (material.texture < 0) {
    material.is_alpha_masked = false;
    return alpha >= material.alpha_cutoff;
  }
  // alpha · texel >= cutoff, written as a condition on the texel alone
  if (!(alpha > 0) || material.alpha_cutoff / alpha > 1) return false;
  material.alpha_cutoff /= alpha;
  const Holes holes = holes_of(model.textures[static_cast<std::size_t>(material.texture)], material.alpha_cutoff);
  material.is_alpha_masked = holes.some;
  return !holes.all;
}

/// Drops the triangles of a mesh whose mean vertex alpha times `alpha` stays below `cutoff`.
void drop_clear_triangles(Mesh& mesh, float alpha, float cutoff) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    float sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.indices[i + k];  // may still point nowhere: clean_model() comes later
      sum += vertex < mesh.colours.size() ? static_cast<float>(mesh.colours[vertex].a) / 255.0f : 1.0f;
    }
    if (alpha * sum / 3.0f < cutoff) continue;
    for (std::size_t k = 0; k < 3; ++k) mesh.indices[kept++] = mesh.indices[i + k];
  }
  mesh.indices.resize(kept);
}

}  // namespace

void settle_transparency(Model& model) {
  const std::size_t before = model.drawn_triangles();
  std::size_t absent_materials = 0;
  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    Material& material = model.materials[m];
    const bool has_vertex_alpha = material.is_alpha_masked && material.texture < 0;
    const float alpha = static_cast<float>(material.base_colour.a) / 255.0f;
    const bool is_present = settle_material(material, model);
    if (!is_present) ++absent_materials;
    if (is_present && !has_vertex_alpha) continue;
    for (Mesh& mesh : model.meshes) {
      if (mesh.material != static_cast<int>(m)) continue;
      if (!is_present) {
        mesh.indices.clear();
      } else if (!mesh.colours.empty()) {
        drop_clear_triangles(mesh, alpha, material.alpha_cutoff);
      }
    }
  }
  const std::size_t absent = before - model.drawn_triangles();
  if (absent > 0) {
    model.warnings.push_back(fmt::format(
        "left out see-through triangles (alpha below the cut-off, as in glass): {}; materials absent altogether: {}",
        absent, absent_materials));
  }
  drop_empty_meshes(model);
}

}  // namespace farfield

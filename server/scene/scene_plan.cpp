// SPDX-License-Identifier: Apache-2.0
#include "server/scene/scene_plan.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace farfield {
namespace {

Status check_mesh(const Mesh& mesh, std::size_t index, std::size_t material_count) {
  const auto bad = [&](const char* what) {
    return fail(ErrorCode::kBadData, "mesh {} ('{}'): {}; the importer or generator made it wrong", index, mesh.name,
                what);
  };
  const std::size_t vertices = mesh.positions.size();
  if (mesh.indices.size() % 3 != 0) return bad("the number of indices is not a multiple of three");
  if (!mesh.normals.empty() && mesh.normals.size() != vertices) return bad("normals and positions differ in number");
  if (!mesh.uvs.empty() && mesh.uvs.size() != vertices) return bad("uvs and positions differ in number");
  if (!mesh.colours.empty() && mesh.colours.size() != vertices) return bad("colours and positions differ in number");
  if (mesh.material < 0 || static_cast<std::size_t>(mesh.material) >= material_count) return bad("no such material");
  const std::uint32_t largest = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.indices.size(), 1 << 16), 0u,
      [&](const tbb::blocked_range<std::size_t>& range, std::uint32_t value) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) value = std::max(value, mesh.indices[i]);
        return value;
      },
      [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); });
  if (!mesh.indices.empty() && largest >= vertices) return bad("an index points past the last vertex");
  return {};
}

Status check_model(const Model& model, std::size_t material_count) {
  for (std::size_t i = 0; i < model.textures.size(); ++i) {
    const TextureImage& texture = model.textures[i];
    if (texture.width < 1 || texture.height < 1 ||
        texture.rgba.size() !=
            std::size_t{4} * static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height))
      return fail(ErrorCode::kBadData, "texture {} ('{}'): {} bytes are not {}×{} texels", i, texture.name,
                  texture.rgba.size(), texture.width, texture.height);
  }
  for (std::size_t i = 0; i < model.materials.size(); ++i)
    if (model.materials[i].texture >= static_cast<int>(model.textures.size()))
      return fail(ErrorCode::kBadData, "material {} ('{}'): there is no texture {}", i, model.materials[i].name,
                  model.materials[i].texture);
  for (std::size_t i = 0; i < model.meshes.size(); ++i)
    if (Status checked = check_mesh(model.meshes[i], i, material_count); !checked) return checked;
  for (std::size_t i = 0; i < model.instances.size(); ++i)
    if (model.instances[i].mesh < 0 || static_cast<std::size_t>(model.instances[i].mesh) >= model.meshes.size())
      return fail(ErrorCode::kBadData, "instance {}: there is no mesh {}", i, model.instances[i].mesh);
  return {};
}

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Box transformed_bounds(const Mesh& mesh, const glm::dmat3& linear, const glm::dvec3& offset) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.positions.size(), 1 << 14), Box{},
      [&](const tbb::blocked_range<std::size_t>& range, Box box) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const glm::dvec3 p = linear * glm::dvec3(mesh.positions[i]) + offset;
          if (is_finite(p)) box.include(p);
        }
        return box;
      },
      [](Box a, const Box& b) {
        a.include(b);
        return a;
      });
}

Box world_bounds(const Model& model) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, model.instances.size()), Box{},
      [&](const tbb::blocked_range<std::size_t>& range, Box box) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const MeshInstance& instance = model.instances[i];
          const Mesh& mesh = model.meshes[static_cast<std::size_t>(instance.mesh)];
          if (!mesh.indices.empty())
            box.include(transformed_bounds(mesh, glm::dmat3(instance.world_from_mesh), instance.world_from_mesh[3]));
        }
        return box;
      },
      [](Box a, const Box& b) {
        a.include(b);
        return a;
      });
}

glm::dvec3 snapped(const glm::dvec3& p, double step) {
  return glm::round(p / step) * step;
}

}  // namespace

Result<ScenePlan> plan_scene(const Model& model) {
  const Material plain;  // for models that bring no materials at all
  const std::span<const Material> materials =
      model.materials.empty() ? std::span<const Material>(&plain, 1) : std::span<const Material>(model.materials);
  if (Status checked = check_model(model, materials.size()); !checked)
    return fail_within(model.name, std::move(checked).error());
  const Box bounds = world_bounds(model);
  if (bounds.is_empty())
    return fail(ErrorCode::kBadData, "{}: the model has no triangles to draw; check the file and its import warnings",
                model.name);

  ScenePlan plan;
  plan.frame = choose_scene_frame(bounds);
  std::vector<std::size_t> uses(model.meshes.size(), 0);
  for (const MeshInstance& instance : model.instances) ++uses[static_cast<std::size_t>(instance.mesh)];
  const auto is_instanced = [&](std::size_t mesh) {
    return uses[mesh] >= 2 && model.meshes[mesh].indices.size() / 3 > kInstancedTriangles;
  };
  const auto surface_of = [&](const Material& material) {
    SurfaceState surface{material.texture < 0 ? -1 : material.texture,
                         material.is_alpha_masked && material.texture >= 0, 0.5f};
    if (surface.is_alpha_masked) surface.alpha_cutoff = material.alpha_cutoff;
    return surface;
  };

  // Flattened meshes first: part i is then stored mesh i.
  std::vector<std::pair<std::size_t, const MeshInstance*>> instanced;
  for (const MeshInstance& instance : model.instances) {
    const auto index = static_cast<std::size_t>(instance.mesh);
    const Mesh& mesh = model.meshes[index];
    if (mesh.indices.empty()) continue;
    if (is_instanced(index)) {
      instanced.emplace_back(index, &instance);
      continue;
    }
    const Material& material = materials[static_cast<std::size_t>(mesh.material)];
    const SurfaceState surface = surface_of(material);
    auto stored = std::find_if(plan.meshes.begin(), plan.meshes.end(),
                               [&](const StoredMeshPlan& candidate) { return candidate.surface == surface; });
    if (stored == plan.meshes.end()) {
      plan.parts.push_back({static_cast<std::uint32_t>(plan.meshes.size()), glm::mat4x3(1)});
      stored = plan.meshes.insert(plan.meshes.end(), StoredMeshPlan{surface, plan.frame.step_m, {}});
    }
    // The translation is rounded finer than the grid, so that the last bits of a large world coordinate cannot tip
    // the rounding of single vertices.
    const glm::dvec3 offset =
        snapped(glm::dvec3(instance.world_from_mesh[3]) - plan.frame.origin, plan.frame.step_m / 8);
    stored->sources.push_back({&mesh, material.base_colour, glm::dmat3(instance.world_from_mesh), offset});
  }

  std::vector<std::int64_t> stored_of(model.meshes.size(), -1);
  std::vector<glm::dvec3> centre_of(model.meshes.size(), glm::dvec3(0));
  for (const auto& [index, instance] : instanced) {
    const Mesh& mesh = model.meshes[index];
    if (stored_of[index] < 0) {
      const Box mesh_bounds = transformed_bounds(mesh, glm::dmat3(1), glm::dvec3(0));
      if (mesh_bounds.is_empty()) continue;
      const Material& material = materials[static_cast<std::size_t>(mesh.material)];
      const double step = mesh_step(mesh_bounds);
      centre_of[index] = snapped(mesh_bounds.center(), step);
      stored_of[index] = static_cast<std::int64_t>(plan.meshes.size());
      plan.meshes.push_back(
          {surface_of(material), step, {{&mesh, material.base_colour, glm::dmat3(1), -centre_of[index]}}});
    }
    const glm::dmat3 linear(instance->world_from_mesh);
    const glm::dvec3 offset =
        linear * centre_of[index] +
        snapped(glm::dvec3(instance->world_from_mesh[3]) - plan.frame.origin, plan.frame.step_m / 8);
    if (!is_finite(offset)) continue;
    plan.parts.push_back(
        {static_cast<std::uint32_t>(stored_of[index]),
         glm::mat4x3(glm::vec3(linear[0]), glm::vec3(linear[1]), glm::vec3(linear[2]), glm::vec3(offset))});
  }
  return plan;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Scene::build: model → plan → textures → stored meshes → placed chunks → ray-tracing structure.
#include <chrono>

#include "common/shading/shading.h"
#include "server/scene/scene_plan.h"
#include "server/scene/scene_state.h"

namespace farfield {
namespace {

// The mask a texture is filtered for: that of the first masked material that uses it.
std::vector<MipOptions> mip_options(const Model& model) {
  std::vector<MipOptions> options(model.textures.size());
  for (MipOptions& option : options) option.largest_edge = kMaxTextureEdge;
  for (const Material& material : model.materials) {
    if (material.texture < 0 || !material.is_alpha_masked) continue;
    MipOptions& option = options[static_cast<std::size_t>(material.texture)];
    if (option.keeps_alpha) continue;
    option.keeps_alpha = true;
    option.alpha_cutoff = material.alpha_cutoff;
  }
  return options;
}

struct Hasher {
  ContentHash hash = 0;
  template <class T>
  void add(const T& value) {
    hash = hash_value(value, hash);
  }
};

}  // namespace

void Scene::State::derive() {
  for (std::uint32_t i = 0; i < textures.size(); ++i) {
    texture_infos.push_back({textures.hash(i), textures.width(i), textures.height(i), textures.level_count(i)});
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const glm::mat4x3& placement = parts[i].scene_from_mesh;
    const glm::mat3 m(placement);
    light_from_mesh.push_back(glm::mat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])));
    if (placement == glm::mat4x3(1) && flattened_parts == i) ++flattened_parts;
    statistics.drawn_triangles += meshes[parts[i].mesh].triangle_count();
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    mesh_of_stored_chunk.insert(mesh_of_stored_chunk.end(), meshes[m].chunks.size(), static_cast<std::uint32_t>(m));
    statistics.stored_triangles += meshes[m].triangle_count();
  }
  std::vector<Box> boxes;
  for (const SceneChunk& chunk : placed.chunks) boxes.push_back(chunk.bounds), bounds.include(chunk.bounds);
  index = ChunkIndex(boxes);
  statistics.parts = parts.size();
  statistics.chunks = placed.chunks.size();
  statistics.textures = textures.size();
}

Result<std::shared_ptr<const Scene>> Scene::build(Model model) {
  const auto start = std::chrono::steady_clock::now();
  Result<ScenePlan> plan = plan_scene(model);
  if (!plan) return tl::unexpected(std::move(plan).error());

  auto scene = std::shared_ptr<Scene>(new Scene());
  State& state = *scene->state_;
  state.name = model.name;
  state.origin = plan->frame.origin;
  state.background = kDefaultBackground;

  const std::vector<MipOptions> options = mip_options(model);
  for (std::size_t i = 0; i < model.textures.size(); ++i) {
    state.textures.add(model.textures[i], options[i]);
    std::vector<std::uint8_t>().swap(model.textures[i].rgba);  // the chain replaces it
  }

  for (const StoredMeshPlan& mesh_plan : plan->meshes) {
    const int texture = mesh_plan.surface.texture;
    Result<StoredMesh> mesh =
        build_stored_mesh(mesh_plan, texture < 0 ? 0 : state.textures.hash(static_cast<std::uint32_t>(texture)));
    if (!mesh) return fail_within(state.name, std::move(mesh).error());
    state.meshes.push_back(std::move(*mesh));
  }
  for (const PartPlan& part : plan->parts) state.parts.push_back({part.mesh, part.scene_from_mesh, {}});
  state.statistics.materials = model.materials.size();
  // The plan points into the model; neither is needed any longer, and Embree is about to need the memory.
  plan->meshes.clear();
  model = Model{};

  state.placed = place_chunks(state.meshes, state.parts);
  state.derive();
  if (state.bounds.is_empty())
    return fail(ErrorCode::kBadData, "{}: no triangle of the model has area; check its units and import warnings",
                state.name);

  Result<RayScene> rays = RayScene::build(state.meshes, state.parts, state.flattened_parts, state.textures);
  if (!rays) return fail_within(state.name, std::move(rays).error());
  state.rays.set(std::move(*rays));

  Hasher hasher;
  for (const StoredMesh& mesh : state.meshes) {
    for (const StoredChunk& chunk : mesh.chunks) {
      hasher.add(chunk.hash);
      hasher.add(chunk.origin);
    }
  }
  for (const ScenePart& part : state.parts) {
    hasher.add(part.mesh);
    hasher.add(part.scene_from_mesh);
  }
  for (const TextureInfo& texture : state.texture_infos) hasher.add(texture.hash);
  hasher.add(state.background);
  state.hash = hasher.hash;
  state.statistics.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return scene;
}

}  // namespace farfield

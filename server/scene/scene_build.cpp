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
    const std::uint32_t texture = state.textures.add(model.textures[i], options[i]);
    std::vector<std::uint8_t>().swap(model.textures[i].rgba);  // the chain replaces it
    state.texture_infos.push_back({state.textures.hash(texture), state.textures.width(texture),
                                   state.textures.height(texture), state.textures.level_count(texture)});
  }

  for (const StoredMeshPlan& mesh_plan : plan->meshes) {
    const int texture = mesh_plan.surface.texture;
    Result<StoredMesh> mesh =
        build_stored_mesh(mesh_plan, texture < 0 ? 0 : state.textures.hash(static_cast<std::uint32_t>(texture)));
    if (!mesh) return fail_within(state.name, std::move(mesh).error());
    state.meshes.push_back(std::move(*mesh));
  }
  for (const PartPlan& part : plan->parts) {
    state.parts.push_back({part.mesh, part.scene_from_mesh, {}});
    const glm::mat3 m(part.scene_from_mesh);
    state.light_from_mesh.push_back(glm::mat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])));
    if (part.scene_from_mesh == glm::mat4x3(1) && state.flattened_parts + 1 == state.parts.size())
      ++state.flattened_parts;
  }
  state.statistics.materials = model.materials.size();
  // The plan points into the model; neither is needed any longer, and Embree is about to need the memory.
  plan->meshes.clear();
  model = Model{};

  state.placed = place_chunks(state.meshes, state.parts);
  std::vector<Box> boxes;
  for (const SceneChunk& chunk : state.placed.chunks) boxes.push_back(chunk.bounds);
  state.index = ChunkIndex(boxes);
  for (const Box& box : boxes) state.bounds.include(box);
  if (state.bounds.is_empty())
    return fail(ErrorCode::kBadData, "{}: no triangle of the model has area; check its units and import warnings",
                state.name);

  Result<RayScene> rays = RayScene::build(state.meshes, state.parts, state.flattened_parts, state.textures);
  if (!rays) return fail_within(state.name, std::move(rays).error());
  state.rays = std::move(*rays);

  Hasher hasher;
  for (std::size_t m = 0; m < state.meshes.size(); ++m) {
    for (const StoredChunk& chunk : state.meshes[m].chunks) {
      hasher.add(chunk.hash);
      hasher.add(chunk.origin);
      state.mesh_of_stored_chunk.push_back(static_cast<std::uint32_t>(m));
    }
    state.statistics.stored_triangles += state.meshes[m].triangle_count();
  }
  for (const ScenePart& part : state.parts) {
    hasher.add(part.mesh);
    hasher.add(part.scene_from_mesh);
    state.statistics.drawn_triangles += state.meshes[part.mesh].triangle_count();
  }
  for (const TextureInfo& texture : state.texture_infos) hasher.add(texture.hash);
  hasher.add(state.background);
  state.hash = hasher.hash;
  state.statistics.parts = state.parts.size();
  state.statistics.chunks = state.placed.chunks.size();
  state.statistics.textures = state.texture_infos.size();
  state.statistics.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return scene;
}

}  // namespace farfield

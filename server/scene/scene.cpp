// SPDX-License-Identifier: Apache-2.0
#include "server/scene/scene.h"

#include "common/codec/texture_codec.h"
#include "server/scene/scene_state.h"

namespace farfield {

Scene::Scene() : state_(std::make_unique<State>()) {}
Scene::~Scene() = default;

const std::string& Scene::name() const {
  return state_->name;
}
const glm::dvec3& Scene::origin() const {
  return state_->origin;
}
const Box& Scene::bounds() const {
  return state_->bounds;
}
ContentHash Scene::hash() const {
  return state_->hash;
}
const SceneStatistics& Scene::statistics() const {
  return state_->statistics;
}
glm::u8vec3 Scene::background() const {
  return state_->background;
}
bool Scene::is_textured(std::uint32_t part) const { return state_->meshes[state_->parts[part].mesh].surface.texture >= 0; }
std::span<const ScenePart> Scene::parts() const {
  return state_->parts;
}

void Scene::intersect(const RayPacket& rays, HitPacket& hits) const {
  state_->rays.get().intersect(rays, hits, true);
}
void Scene::intersect_scattered(const RayPacket& rays, HitPacket& hits) const {
  state_->rays.get().intersect(rays, hits, false);
}
std::uint32_t Scene::occluded(const RayPacket& rays) const {
  return state_->rays.get().occluded(rays);
}
std::uint32_t Scene::occluded_coherent(const RayPacket& rays) const {
  return state_->rays.get().occluded_coherent(rays);
}

std::span<const SceneChunk> Scene::chunks() const {
  return state_->placed.chunks;
}

std::uint32_t Scene::chunk_of(std::uint32_t part, std::uint32_t primitive) const {
  return state_->placed.first_of_part[part] + state_->meshes[state_->parts[part].mesh].chunk_of(primitive);
}

std::vector<std::uint32_t> Scene::chunks_in(const Box& box) const {
  return state_->index.find(box);
}

Chunk Scene::chunk_geometry(std::uint32_t chunk) const {
  const std::uint32_t stored = state_->placed.chunks[chunk].stored_chunk;
  const std::uint32_t mesh_index = state_->mesh_of_stored_chunk[stored];
  const StoredMesh& mesh = state_->meshes[mesh_index];
  return extract_chunk(mesh, mesh.chunks[stored - state_->placed.first_of_mesh[mesh_index]],
                       state_->texture_hash(mesh));
}

SharedBytes Scene::encoded_chunk(std::uint32_t chunk) const {
  const std::uint64_t key = state_->placed.chunks[chunk].stored_chunk;
  return state_->encoded.get(key, [&] { return encode_chunk(chunk_geometry(chunk)); });
}

std::span<const Scene::TextureInfo> Scene::textures() const {
  return state_->texture_infos;
}

TextureLevel Scene::texture_level(std::uint32_t texture, int level) const {
  return state_->textures.texture_level(texture, level);
}

SharedBytes Scene::encoded_texture_level(std::uint32_t texture, int level) const {
  const std::uint64_t key = std::uint64_t{1} << 63 | std::uint64_t{texture} << 8 | static_cast<std::uint64_t>(level);
  return state_->encoded.get(key, [&] { return encode_texture_level(texture_level(texture, level)); });
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Scene::write and Scene::restore. What can be told from the rest in no time is not written but derived.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <concepts>
#include <type_traits>

#include "server/scene/scene_state.h"

namespace farfield {
namespace {

// Records with gaps between their members go member by member: what lies in the gaps is not the scene's.
template <class Archive, class Chunk>
void each_member(Archive&& archive, Chunk& chunk)
  requires std::same_as<std::remove_const_t<Chunk>, StoredChunk>
{
  archive(chunk.first_triangle), archive(chunk.triangle_count), archive(chunk.first_vertex), archive(chunk.vertex_count);
  archive(chunk.origin), archive(chunk.hash);
}
template <class Archive, class Part>
void each_member(Archive&& archive, Part& part)
  requires std::same_as<std::remove_const_t<Part>, ScenePart>
{
  archive(part.mesh), archive(part.scene_from_mesh), archive(part.bounds);
}
template <class Archive, class Chunk>
void each_member(Archive&& archive, Chunk& chunk)
  requires std::same_as<std::remove_const_t<Chunk>, SceneChunk>
{
  archive(chunk.hash), archive(chunk.part), archive(chunk.stored_chunk), archive(chunk.triangles), archive(chunk.bounds);
  archive(chunk.cone_axis), archive(chunk.cone_cos), archive(chunk.scene_from_chunk);
}

template <class Record>
void put_records(const std::vector<Record>& records, MemoryImageWriter& out) {
  out.put<std::uint64_t>(records.size());
  for (const Record& record : records) each_member([&out](const auto& member) { out.put(member); }, record);
}

template <class Record>
std::vector<Record> get_records(MemoryImageReader& in) {
  constexpr std::size_t kMostGapBytes = 8;
  std::vector<Record> records(in.get_count(sizeof(Record) - kMostGapBytes));
  for (Record& record : records) each_member([&in](auto& member) { member = in.get<std::remove_reference_t<decltype(member)>>(); }, record);
  return records;
}

void write_mesh(const StoredMesh& mesh, MemoryImageWriter& out) {
  out.put<std::int32_t>(mesh.surface.texture);
  out.put<std::uint8_t>(mesh.surface.is_alpha_masked);
  out.put(mesh.surface.alpha_cutoff);
  out.put_array(mesh.positions);
  out.put_array(mesh.surfaces);
  out.put_array(mesh.uvs);
  out.put_array(mesh.indices);
  put_records(mesh.chunks, out);
  out.put_array(mesh.chunk_at_block);
}

/// Whether chunks cut triangles and vertices into runs without gaps, and every triangle names vertices of its chunk.
bool has_sound_chunks(const StoredMesh& mesh) {
  std::size_t triangle = 0, vertex = 0;
  for (const StoredChunk& chunk : mesh.chunks) {
    if (chunk.first_triangle != triangle || chunk.first_vertex != vertex || chunk.triangle_count == 0) return false;
    triangle += chunk.triangle_count, vertex += chunk.vertex_count;
    if (triangle > mesh.triangle_count() || vertex > mesh.vertex_count()) return false;
    const auto first = mesh.indices.begin() + 3 * static_cast<std::ptrdiff_t>(chunk.first_triangle);
    const auto [least, most] = std::minmax_element(first, first + 3 * static_cast<std::ptrdiff_t>(chunk.triangle_count));
    if (*least < chunk.first_vertex || *most - chunk.first_vertex >= chunk.vertex_count) return false;
  }
  return triangle == mesh.triangle_count() && vertex == mesh.vertex_count();
}

/// Whether StoredMesh::chunk_of() ends, at the right chunk.
bool has_sound_blocks(const StoredMesh& mesh) {
  if (mesh.chunk_at_block.size() != mesh.triangle_count() / 64 + 1) return false;
  for (std::size_t block = 0; 64 * block < mesh.triangle_count(); ++block) {
    const std::uint32_t chunk = mesh.chunk_at_block[block];
    if (chunk >= mesh.chunks.size()) return false;
    if (64 * block - mesh.chunks[chunk].first_triangle >= mesh.chunks[chunk].triangle_count) return false;
  }
  return true;
}

/// Whether all floats of the entries are finite. Entries are nothing but floats.
template <class T>
bool are_finite(const std::vector<T>& entries) {
  // Zero times what is not finite is not a number, and stays it: no branch per value.
  float sum = 0;
  for (const T& entry : entries) {
    const auto* values = reinterpret_cast<const float*>(&entry);
    for (std::size_t i = 0; i < sizeof(T) / sizeof(float); ++i) sum += 0.0f * values[i];
  }
  return std::isfinite(sum);
}

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool is_finite_or_empty(const Box& box) { return (is_finite(box.min) && is_finite(box.max)) || (box.min == Box().min && box.max == Box().max); }

StoredMesh read_mesh(MemoryImageReader& in, std::size_t textures) {
  StoredMesh mesh;
  mesh.surface.texture = in.get<std::int32_t>();
  mesh.surface.is_alpha_masked = in.get<std::uint8_t>() != 0;
  mesh.surface.alpha_cutoff = in.get<float>();
  mesh.positions = in.get_array<glm::vec3>();
  mesh.surfaces = in.get_array<VertexSurface>();
  mesh.uvs = in.get_array<glm::vec2>();
  mesh.indices = in.get_array<std::uint32_t>();
  mesh.chunks = get_records<StoredChunk>(in);
  mesh.chunk_at_block = in.get_array<std::uint32_t>();
  const bool has_texture = mesh.surface.texture >= 0;
  in.require(mesh.surface.texture >= -1 && mesh.surface.texture < static_cast<std::int64_t>(textures));
  in.require((has_texture || !mesh.surface.is_alpha_masked) && !std::isnan(mesh.surface.alpha_cutoff));
  in.require(mesh.surfaces.size() == mesh.vertex_count() && mesh.indices.size() % 3 == 0);
  in.require(has_texture ? mesh.uvs.size() == mesh.vertex_count() : mesh.uvs.empty());
  in.require(mesh.indices.empty() || mesh.vertex_count() > 0);
  in.require(are_finite(mesh.positions) && are_finite(mesh.uvs));
  in.require(in.is_valid() && has_sound_chunks(mesh) && has_sound_blocks(mesh));
  return mesh;
}

/// The tables beside the chunks, as place_chunks() makes them. False: the chunks are not those of the parts.
bool number_chunks(const std::vector<StoredMesh>& meshes, const std::vector<ScenePart>& parts, PlacedChunks& placed) {
  std::size_t stored = 0, total = 0;
  for (const StoredMesh& mesh : meshes) {
    placed.first_of_mesh.push_back(static_cast<std::uint32_t>(stored));
    stored += mesh.chunks.size();
  }
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    placed.first_of_part.push_back(static_cast<std::uint32_t>(total));
    const std::size_t count = meshes[parts[p].mesh].chunks.size();
    if (total + count > placed.chunks.size()) return false;
    for (std::size_t c = 0; c < count; ++c) {
      const SceneChunk& chunk = placed.chunks[total + c];
      if (chunk.part != p || chunk.stored_chunk != placed.first_of_mesh[parts[p].mesh] + c) return false;
    }
    total += count;
  }
  return total == placed.chunks.size();
}

}  // namespace

void Scene::write(MemoryImageWriter& out) const {
  const State& state = *state_;
  out.put_text(state.name);
  out.put(state.origin);
  out.put(state.hash);
  out.put(state.background);
  out.put<std::uint64_t>(state.statistics.materials);
  state.textures.write(out);
  out.put<std::uint64_t>(state.meshes.size());
  for (const StoredMesh& mesh : state.meshes) write_mesh(mesh, out);
  put_records(state.parts, out);
  put_records(state.placed.chunks, out);
}

Result<std::shared_ptr<const Scene>> Scene::restore(MemoryImageReader& in) {
  const auto start = std::chrono::steady_clock::now();
  constexpr std::size_t kLeastMeshBytes = 9 + 6 * sizeof(std::uint64_t);
  auto scene = std::shared_ptr<Scene>(new Scene());
  State& state = *scene->state_;
  state.name = in.get_text();
  state.origin = in.get<glm::dvec3>();
  state.hash = in.get<ContentHash>();
  state.background = in.get<glm::u8vec3>();
  state.statistics.materials = in.get<std::uint64_t>();
  in.require(is_finite(state.origin));
  state.textures.read(in);
  std::size_t left = in.get_count(kLeastMeshBytes);
  state.meshes.reserve(left);
  for (; left > 0 && in.is_valid(); --left) state.meshes.push_back(read_mesh(in, state.textures.size()));
  state.parts = get_records<ScenePart>(in);
  state.placed.chunks = get_records<SceneChunk>(in);
  for (const ScenePart& part : state.parts) {
    in.require(part.mesh < state.meshes.size());
    for (int column = 0; column < 4; ++column) in.require(is_finite(part.scene_from_mesh[column]));
  }
  for (const SceneChunk& chunk : state.placed.chunks) in.require(is_finite_or_empty(chunk.bounds));
  if (!in.is_valid() || !number_chunks(state.meshes, state.parts, state.placed)) {
    return fail(ErrorCode::kBadData, "the prepared scene is damaged");
  }
  state.derive();
  if (state.bounds.is_empty()) return fail(ErrorCode::kBadData, "the prepared scene is empty");
  state.rays.build_later([&state] { return RayScene::build(state.meshes, state.parts, state.flattened_parts, state.textures); });
  state.statistics.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return scene;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/scene/chunk_emitter.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/shading/shading.h"

namespace farfield {
namespace {

constexpr int kUvBits = 18;              // uv grid 2⁻¹⁸: 1/64 texel of the largest texture
constexpr double kExactFloat = 1 << 24;  // integers up to here are floats

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

glm::dmat3 cofactor(const glm::dmat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

}  // namespace

TriangleSources::TriangleSources(std::span<const MeshSource> sources) : sources_(sources), first_{0} {
  first_.reserve(sources.size() + 1);
  for (const MeshSource& source : sources) first_.push_back(first_.back() + source.mesh->indices.size() / 3);
}

void TriangleSources::Cursor::seek(std::size_t id) {
  const std::vector<std::size_t>& first = sources_->first_;
  if (id < first[at_] || id >= first[at_ + 1])
    at_ = static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), id) - first.begin()) - 1;
  vertices_ = source().mesh->indices.data() + 3 * (id - first[at_]);
}

bool TriangleSources::Cursor::corners(std::size_t id, glm::dvec3 out[3]) {
  seek(id);
  const MeshSource& from = source();
  for (int k = 0; k < 3; ++k) {
    out[k] = from.linear * glm::dvec3(from.mesh->positions[vertices_[k]]) + from.offset;
    if (!is_finite(out[k])) return false;
  }
  return true;
}

ChunkEmitter::ChunkEmitter(const StoredMeshPlan& plan, const TriangleSources& sources, ContentHash texture,
                           StoredMesh& out)
    : plan_(plan), cursor_(sources.cursor()), texture_(texture), out_(out) {}

glm::i16vec2 ChunkEmitter::normal_code(const glm::dvec3& normal, const glm::dvec3& face_normal) const {
  const double length = glm::length(normal);
  // Files do contain zero and NaN normals: such vertices are flat.
  if (!(length > 0) || !std::isfinite(length)) return encode_normal(glm::vec3(glm::normalize(face_normal)));
  return encode_normal(glm::vec3(normal / length));
}

glm::u8vec4 ChunkEmitter::colour_code(std::uint32_t vertex) {
  const MeshSource& source = cursor_.source();
  const glm::u8vec4 base = source.base_colour;
  if (source.mesh->colours.empty()) return {base.r, base.g, base.b, 255};
  const glm::u8vec4 own = source.mesh->colours[vertex];
  glm::u8vec4 product{0, 0, 0, 255};
  for (int c = 0; c < 3; ++c)
    product[c] = base[c] == 255 ? own[c] : linear_to_srgb(srgb_to_linear(base[c]) * srgb_to_linear(own[c]));
  return product;
}

bool ChunkEmitter::add_triangle(const TriangleItem& item) {
  glm::dvec3 position[3];
  if (!cursor_.corners(item.triangle, position)) return false;
  const Mesh& mesh = *cursor_.source().mesh;
  if (cursor_.source_index() != normal_source_) {
    normal_source_ = cursor_.source_index();
    normal_from_mesh_ = cofactor(cursor_.source().linear);
  }
  Corner corner[3];
  glm::dvec3 grid[3];
  for (int k = 0; k < 3; ++k) {
    grid[k] = glm::round(position[k] / plan_.step);
    for (int a = 0; a < 3; ++a) corner[k].grid[a] = static_cast<std::int32_t>(grid[k][a]);
  }
  const glm::dvec3 face_normal = glm::cross(grid[1] - grid[0], grid[2] - grid[0]);
  if (!(glm::dot(face_normal, face_normal) > 0)) return false;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t vertex = cursor_.vertices()[k];
    corner[k].normal = normal_code(
        mesh.normals.empty() ? face_normal : normal_from_mesh_ * glm::dvec3(mesh.normals[vertex]), face_normal);
    corner[k].colour = colour_code(vertex);
    corner[k].uv = glm::vec2(0);
    if (plan_.surface.texture >= 0 && !mesh.uvs.empty()) {
      const glm::vec2 uv = mesh.uvs[vertex];
      if (std::isfinite(uv.x) && std::isfinite(uv.y)) corner[k].uv = uv;
    }
  }
  corners_.insert(corners_.end(), corner, corner + 3);
  return true;
}

// Textures repeat, so whole repeats are taken off each chunk; what remains is rounded to a grid that floats hold
// exactly.
void ChunkEmitter::snap_uvs() {
  glm::dvec2 low(corners_.front().uv), high = low;
  for (const Corner& corner : corners_) {
    low = glm::min(low, glm::dvec2(corner.uv));
    high = glm::max(high, glm::dvec2(corner.uv));
  }
  const glm::dvec2 whole = glm::floor(low);
  const double reach = std::max(high.x - whole.x, high.y - whole.y);
  int bits = kUvBits;
  while (std::ldexp(reach, bits) > kExactFloat) --bits;
  for (Corner& corner : corners_) {
    const glm::dvec2 uv = glm::dvec2(corner.uv) - whole;
    corner.uv = {static_cast<float>(std::ldexp(std::round(std::ldexp(uv.x, bits)), -bits)),
                 static_cast<float>(std::ldexp(std::round(std::ldexp(uv.y, bits)), -bits))};
  }
}

std::uint32_t ChunkEmitter::find_or_add(const Corner& corner, std::uint32_t first_vertex) {
  std::size_t slot = hash_value(corner) % table_.size();
  while (table_[slot] != 0) {
    const std::uint32_t at = table_[slot] - 1u;
    if (std::memcmp(&unique_[at], &corner, sizeof corner) == 0) return first_vertex + at;
    slot = (slot + 1) % table_.size();
  }
  unique_.push_back(corner);
  table_[slot] = static_cast<std::uint16_t>(unique_.size());
  return first_vertex + static_cast<std::uint32_t>(unique_.size()) - 1;
}

void ChunkEmitter::emit(std::span<const TriangleItem> cluster) {
  corners_.clear();
  unique_.clear();
  table_.fill(0);
  for (const TriangleItem& item : cluster) add_triangle(item);
  if (corners_.empty()) return;
  if (plan_.surface.texture >= 0) snap_uvs();

  StoredChunk chunk;
  chunk.first_triangle = static_cast<std::uint32_t>(out_.indices.size() / 3);
  chunk.triangle_count = static_cast<std::uint32_t>(corners_.size() / 3);
  chunk.first_vertex = static_cast<std::uint32_t>(out_.positions.size());
  for (const Corner& corner : corners_) out_.indices.push_back(find_or_add(corner, chunk.first_vertex));
  chunk.vertex_count = static_cast<std::uint32_t>(unique_.size());
  store(chunk);
  out_.chunks.push_back(chunk);
}

// The hash covers what extract_chunk() gives: codes relative to the chunk's origin, in metres.
void ChunkEmitter::store(StoredChunk& chunk) {
  std::int32_t low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = high[a] = unique_.front().grid[a];
    for (const Corner& corner : unique_) {
      low[a] = std::min(low[a], corner.grid[a]);
      high[a] = std::max(high[a], corner.grid[a]);
    }
  }
  std::int32_t origin[3];
  for (int a = 0; a < 3; ++a) {
    origin[a] = low[a] + (high[a] - low[a]) / 2;
    chunk.origin[a] = static_cast<float>(origin[a] * plan_.step);
  }
  for (const Corner& corner : unique_) {
    out_.positions.emplace_back(static_cast<float>(corner.grid[0] * plan_.step),
                                static_cast<float>(corner.grid[1] * plan_.step),
                                static_cast<float>(corner.grid[2] * plan_.step));
    out_.surfaces.push_back({corner.normal, corner.colour});
    if (plan_.surface.texture >= 0) out_.uvs.push_back(corner.uv);
  }
  for (Corner& corner : unique_)
    for (int a = 0; a < 3; ++a) corner.grid[a] -= origin[a];
  struct Header {
    double step;
    ContentHash texture;
    std::uint32_t is_alpha_masked;
    float alpha_cutoff;
  };
  const Header header{plan_.step, texture_, plan_.surface.is_alpha_masked ? 1u : 0u, plan_.surface.alpha_cutoff};
  ContentHash hash = hash_values(std::span<const Corner>(unique_), hash_value(header));
  std::array<std::uint16_t, 3 * kMaxChunkTriangles> local;
  const std::size_t count = 3 * std::size_t{chunk.triangle_count};
  for (std::size_t i = 0; i < count; ++i)
    local[i] = static_cast<std::uint16_t>(out_.indices[3 * std::size_t{chunk.first_triangle} + i] - chunk.first_vertex);
  chunk.hash = hash_values(std::span<const std::uint16_t>(local.data(), count), hash);
}

}  // namespace farfield

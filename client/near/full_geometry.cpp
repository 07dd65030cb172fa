// SPDX-License-Identifier: Apache-2.0
#include "client/near/full_geometry.h"

#include <epoxy/gl.h>

#include <limits>
#include <map>
#include <tuple>

#include "client/near/surface_program.h"
#include "client/near/texture_cache.h"

namespace farfield::client {
namespace {

constexpr std::size_t kBufferIndices = 3u << 20;  // a buffer is closed at a million triangles

struct HeldChunk {
  SurfaceBounds bounds;
  std::uint32_t first_index = 0, index_count = 0;
};

/// Chunks of one texture and mask.
struct GeometryBuffer {
  std::shared_ptr<const DecodedTexture> texture;
  bool is_alpha_masked = false;
  float alpha_cutoff = 0.5f;
  Buffer vertices, indices;
  VertexArrayName array;
  std::vector<HeldChunk> chunks;
};

/// A buffer while it is being filled, on the CPU.
struct PendingBuffer {
  GeometryBuffer buffer;
  std::vector<SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices;

  std::size_t upload() {
    const auto vertex_bytes = std::as_bytes(std::span(vertices));
    const auto index_bytes = std::as_bytes(std::span(indices));
    buffer.vertices = Buffer::make(vertex_bytes.size());
    buffer.vertices.write(0, vertex_bytes);
    buffer.indices = Buffer::make(index_bytes.size());
    buffer.indices.write(0, index_bytes);
    buffer.array = make_surface_vertex_array(buffer.vertices, buffer.indices);
    vertices.clear(), indices.clear();
    return vertex_bytes.size() + index_bytes.size();
  }
};

}  // namespace

struct FullGeometryRenderer::State {
  State(const GlAbilities& a, const glm::dvec3& o, SurfacePrograms p)
      : abilities(a),
        origin(o),
        programs(std::move(p)),
        // Everything is drawn in every frame, so nothing may be evicted.
        textures(std::numeric_limits<std::size_t>::max(), std::numeric_limits<std::size_t>::max(), a.max_texture_edge) {
  }

  GlAbilities abilities;
  glm::dvec3 origin;
  SurfacePrograms programs;
  TextureCache textures;
  std::vector<GeometryBuffer> buffers;
  std::size_t memory_bytes = 0;
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;

  void collect_runs(const GeometryBuffer& buffer, const ViewTransform& view, bool is_culled,
                    FullGeometryStatistics& statistics);
  std::uint32_t draw_runs();
};

FullGeometryRenderer::FullGeometryRenderer() = default;
FullGeometryRenderer::~FullGeometryRenderer() = default;

Result<std::unique_ptr<FullGeometryRenderer>> FullGeometryRenderer::create(
    const GlAbilities& abilities, const glm::dvec3& origin, std::size_t count,
    const std::function<FullGeometryChunk(std::size_t)>& fetch) {
  Result<SurfacePrograms> programs = SurfacePrograms::build();
  if (!programs) return tl::unexpected<Error>(programs.error());
  std::unique_ptr<FullGeometryRenderer> result(new FullGeometryRenderer);
  result->state_ = std::make_unique<State>(abilities, origin, std::move(*programs));
  State& s = *result->state_;

  std::map<std::tuple<std::uint64_t, bool, float>, PendingBuffer> pending;
  const auto close = [&s](PendingBuffer& p) {
    s.memory_bytes += p.upload();
    s.buffers.push_back(std::move(p.buffer));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const FullGeometryChunk placed = fetch(i);
    const Chunk& chunk = placed.chunk;
    const auto key = std::tuple(placed.texture ? placed.texture->serial : 0, chunk.is_alpha_masked, chunk.alpha_cutoff);
    PendingBuffer& p = pending[key];
    p.buffer.texture = placed.texture;
    p.buffer.is_alpha_masked = chunk.is_alpha_masked, p.buffer.alpha_cutoff = chunk.alpha_cutoff;
    glm::dmat4x3 from_chunk = placed.scene_from_chunk;
    from_chunk[3] -= origin;
    HeldChunk held;
    held.first_index = static_cast<std::uint32_t>(p.indices.size());
    held.bounds = append_surface(chunk, glm::mat4x3(from_chunk), p.vertices, p.indices);
    held.index_count = static_cast<std::uint32_t>(p.indices.size()) - held.first_index;
    if (held.index_count > 0) p.buffer.chunks.push_back(held);
    if (p.indices.size() < kBufferIndices) continue;
    close(p);
    pending.erase(key);
  }
  for (auto& [key, p] : pending) {
    if (!p.buffer.chunks.empty()) close(p);
  }
  return result;
}

void FullGeometryRenderer::State::collect_runs(const GeometryBuffer& buffer, const ViewTransform& view, bool is_culled,
                                               FullGeometryStatistics& statistics) {
  counts.clear(), offsets.clear();
  std::uint32_t run_end = std::numeric_limits<std::uint32_t>::max();
  const glm::dmat3& rotation = view.camera_from_scene;
  const glm::dvec3 eye = view.eye - origin;
  for (const HeldChunk& chunk : buffer.chunks) {
    statistics.triangles_held += chunk.index_count / 3;
    if (is_culled) {
      const glm::dvec3 low(chunk.bounds.min), high(chunk.bounds.max), half = 0.5 * (high - low);
      const AffineBox box{rotation * (0.5 * (low + high) - eye),
                          glm::dmat3(rotation[0] * half.x, rotation[1] * half.y, rotation[2] * half.z)};
      if (!view.may_see(box)) continue;
    }
    ++statistics.chunks_drawn;
    statistics.triangles += chunk.index_count / 3;
    if (run_end == chunk.first_index) {
      counts.back() += static_cast<GLsizei>(chunk.index_count);
    } else {
      counts.push_back(static_cast<GLsizei>(chunk.index_count));
      offsets.push_back(reinterpret_cast<const void*>(chunk.first_index * sizeof(std::uint32_t)));
    }
    run_end = chunk.first_index + chunk.index_count;
  }
}

std::uint32_t FullGeometryRenderer::State::draw_runs() {
  if (counts.empty()) return 0;
  const auto runs = static_cast<GLsizei>(counts.size());
  if (!abilities.has_multi_draw) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      glDrawElements(GL_TRIANGLES, counts[i], GL_UNSIGNED_INT, offsets[i]);
    }
    return static_cast<std::uint32_t>(runs);
  }
  if (abilities.is_embedded) {
    glMultiDrawElementsEXT(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(), runs);
  } else {
    glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(), runs);
  }
  return 1;
}

FullGeometryStatistics FullGeometryRenderer::draw(const ViewTransform& view, bool is_culled) {
  State& s = *state_;
  FullGeometryStatistics statistics;
  s.textures.begin_frame();
  begin_scene_drawing(s.abilities);
  s.programs.begin_frame(view, s.origin, DepthConvention::of(s.abilities));
  glActiveTexture(GL_TEXTURE0);
  for (const GeometryBuffer& buffer : s.buffers) {
    s.collect_runs(buffer, view, is_culled, statistics);
    if (s.counts.empty()) continue;
    const GlName texture = buffer.texture ? s.textures.use(*buffer.texture) : 0;
    glBindTexture(GL_TEXTURE_2D, texture);
    s.programs.use({texture != 0, texture != 0 && buffer.is_alpha_masked}, buffer.alpha_cutoff);
    glBindVertexArray(buffer.array.name());
    statistics.draw_calls += s.draw_runs();
  }
  glBindVertexArray(0);
  s.textures.end_frame();
  return statistics;
}

std::size_t FullGeometryRenderer::memory_bytes() const {
  return state_->memory_bytes + state_->textures.held_bytes();
}

}  // namespace farfield::client

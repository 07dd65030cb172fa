// SPDX-License-Identifier: Apache-2.0
#include "client/near/near_renderer.h"

#include <epoxy/gl.h>

#include <list>

#include "client/near/chunks_in_view.h"
#include "client/near/surface_program.h"
#include "client/near/texture_cache.h"

namespace farfield::client {
namespace {

/// A leaf set's near geometry on the GPU; the indices stay here, to be streamed chunk by chunk.
struct PreparedLeaf {
  ContentHash key = 0;
  Buffer vertices;
  VertexArrayName array;
  std::vector<std::uint32_t> indices;
  std::vector<NearBatch> batches;
  std::size_t bytes = 0;
};

}  // namespace

struct NearRenderer::State {
  State(const GlAbilities& a, const NearOptions& o, SurfacePrograms p)
      : abilities(a),
        options(o),
        programs(std::move(p)),
        textures(o.texture_budget_bytes, o.frame_upload_bytes, a.max_texture_edge) {}

  GlAbilities abilities;
  NearOptions options;
  SurfacePrograms programs;
  TextureCache textures;
  Buffer stream = Buffer::make(1 << 16, true);  // this frame's indices
  std::list<PreparedLeaf> prepared;             // most recently drawn first
  ChunksInView in_view;

  PreparedLeaf& prepare(const LeafView& leaf, NearStatistics& statistics);
  void forget_beyond_budget();
};

PreparedLeaf& NearRenderer::State::prepare(const LeafView& leaf, NearStatistics& statistics) {
  const ContentHash key = near_geometry_key(leaf);
  for (auto i = prepared.begin(); i != prepared.end(); ++i) {
    if (i->key != key) continue;
    prepared.splice(prepared.begin(), prepared, i);
    return prepared.front();
  }
  NearBatches batches = near_batches(leaf);
  PreparedLeaf fresh;
  fresh.key = key;
  fresh.bytes = batches.vertices.size() * sizeof(SurfaceVertex);
  fresh.vertices = Buffer::make(fresh.bytes);
  fresh.vertices.write(0, std::as_bytes(std::span(batches.vertices)));
  fresh.array = make_surface_vertex_array(fresh.vertices, stream);
  fresh.indices = std::move(batches.indices);
  fresh.batches = std::move(batches.batches);
  statistics.uploaded_bytes += fresh.bytes;
  prepared.push_front(std::move(fresh));
  forget_beyond_budget();
  return prepared.front();
}

void NearRenderer::State::forget_beyond_budget() {
  std::size_t held = 0;
  for (const PreparedLeaf& leaf : prepared) held += leaf.bytes;
  while (held > options.geometry_budget_bytes && prepared.size() > 1) {
    held -= prepared.back().bytes;
    prepared.pop_back();
  }
}

NearRenderer::NearRenderer() = default;
NearRenderer::~NearRenderer() = default;

Result<std::unique_ptr<NearRenderer>> NearRenderer::create(const GlAbilities& abilities, const NearOptions& options) {
  Result<SurfacePrograms> programs = SurfacePrograms::build();
  if (!programs) return tl::unexpected<Error>(programs.error());
  std::unique_ptr<NearRenderer> result(new NearRenderer);
  result->state_ = std::make_unique<State>(abilities, options, std::move(*programs));
  return result;
}

NearStatistics NearRenderer::draw(const LeafView& leaf, const ViewTransform& view) {
  State& s = *state_;
  NearStatistics statistics;
  s.textures.begin_frame();
  PreparedLeaf& prepared = s.prepare(leaf, statistics);
  const glm::dvec3 centre = leaf.leaf_box.center();
  begin_scene_drawing(s.abilities);
  s.programs.begin_frame(view, centre, DepthConvention::of(s.abilities));

  s.in_view.find(prepared.batches, prepared.indices, centre, view, statistics);
  s.stream.rewrite(std::as_bytes(std::span(s.in_view.indices)));

  glBindVertexArray(prepared.array.name());
  glActiveTexture(GL_TEXTURE0);
  glDepthFunc(GL_GEQUAL);  // of surfaces in one plane the one drawn last shows: nearer to what rays find
  for (const BatchInView& in_view : s.in_view.batches) {
    const NearBatch& batch = *in_view.batch;
    const auto& texture = leaf.chunks[batch.placed_chunk].texture;
    const GlName name = texture ? s.textures.use(*texture) : 0;
    glBindTexture(GL_TEXTURE_2D, name);
    s.programs.use({name != 0, name != 0 && batch.is_alpha_masked}, batch.alpha_cutoff);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(in_view.index_count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(in_view.first_index * sizeof(std::uint32_t)));
    ++statistics.draw_calls;
  }
  glDepthFunc(GL_GREATER);
  glBindVertexArray(0);
  s.textures.end_frame();
  statistics.uploaded_bytes += s.textures.frame_uploaded_bytes();
  return statistics;
}

}  // namespace farfield::client

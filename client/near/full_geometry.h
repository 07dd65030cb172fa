// SPDX-License-Identifier: Apache-2.0
// Draws a whole model, or any selection of its chunks, as triangles: the methods `geometry` and `geometry-culled` that
// the benchmark compares impostors with. Same shaders, same textures, same light as the near geometry.
//
// Uploaded once into buffers of about a million triangles; 28 bytes per vertex and 12 per triangle of GPU memory. The
// chunks of a buffer lie in the order given, so what is visible of it is a few runs, each drawn with one call or all
// with one multi-draw. Belongs to the context's thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "client/gl/gl_context.h"
#include "client/gl/view_transform.h"
#include "client/store/leaf_view.h"

namespace farfield::client {

/// A chunk somewhere in the scene. The chunk itself is only read while it is being added.
struct FullGeometryChunk {
  Chunk chunk;
  glm::dmat4x3 scene_from_chunk{1};
  std::shared_ptr<const DecodedTexture> texture;  // null: none
};

struct FullGeometryStatistics {
  std::uint64_t triangles = 0;  // sent to the GPU
  std::uint64_t triangles_held = 0;
  std::uint32_t draw_calls = 0, chunks_drawn = 0;
};

class FullGeometryRenderer {
 public:
  /// `origin`: scene position that vertices are stored relative to, as floats: near the middle of the model.
  /// `count` chunks are fetched one by one, so that the model is never in memory twice. Chunks are grouped by texture.
  /// Errors: kInternal (shaders).
  static Result<std::unique_ptr<FullGeometryRenderer>> create(
      const GlAbilities& abilities, const glm::dvec3& origin, std::size_t count,
      const std::function<FullGeometryChunk(std::size_t)>& fetch);
  ~FullGeometryRenderer();

  /// `is_culled`: leaves out chunks outside the view's pyramid. Requires: a Framebuffer has begun.
  FullGeometryStatistics draw(const ViewTransform& view, bool is_culled);
  std::size_t memory_bytes() const;

 private:
  FullGeometryRenderer();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield::client

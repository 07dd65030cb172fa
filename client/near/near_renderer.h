// SPDX-License-Identifier: Apache-2.0
// Draws the near geometry of a leaf set: exact triangles, cut at the border of the near region, shaded as everywhere.
//
// In: a LeafView's chunks and textures, and the view. Out: colour and depth in the bound target. Few draw calls:
// when a leaf set is first drawn its chunks are placed, lit and merged on the CPU (about 20 ns per vertex); each frame
// streams the indices of the chunks inside the view's pyramid. Belongs to the context's thread.
#pragma once

#include <cstdint>
#include <memory>

#include "client/gl/gl_context.h"
#include "client/gl/view_transform.h"
#include "client/near/chunks_in_view.h"
#include "client/store/leaf_view.h"

namespace farfield::client {

struct NearOptions {
  std::size_t geometry_budget_bytes = 64u << 20;  // merged leaf sets kept for coming back; the drawn one always is
  std::size_t texture_budget_bytes = 512u << 20;
  std::size_t frame_upload_bytes = 16u << 20;  // of textures
};

class NearRenderer {
 public:
  /// Compiles its shaders. Errors: kInternal.
  static Result<std::unique_ptr<NearRenderer>> create(const GlAbilities& abilities, const NearOptions& options = {});
  ~NearRenderer();

  /// Requires: a Framebuffer has begun. Leaves depth writing and testing on.
  NearStatistics draw(const LeafView& leaf, const ViewTransform& view);

 private:
  NearRenderer();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield::client

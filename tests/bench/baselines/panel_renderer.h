// SPDX-License-Identifier: Apache-2.0
// Draws mesh panels through OpenGL into the same target and depth buffer as near geometry, with projective textures
// (Wilson & Manocha 2003, section 4.3). Belongs to the context's thread.
#pragma once

#include "client/gl/buffer.h"
#include "client/gl/gl_context.h"
#include "client/gl/program.h"
#include "client/gl/view_transform.h"
#include "tests/bench/baselines/mesh_panel.h"

namespace farfield::bench {

class PanelRenderer {
 public:
  /// Errors: kInternal (shaders).
  static Result<PanelRenderer> create(const client::GlAbilities& abilities);

  /// Replaces what was held before.
  void upload(std::span<const MeshPanel> panels);
  /// Panels outside the view's pyramid are left out. Requires: a Framebuffer has begun. Returns: triangles drawn.
  std::size_t draw(const client::ViewTransform& view);

 private:
  /// Triangles that lie together on a face, and the box around them in (u, v, disparity).
  struct Run {
    std::size_t first_index = 0, count = 0;
    glm::dvec3 low{0}, high{0};
  };
  struct Held {
    ViewFrame frame;
    client::Buffer vertices, indices;
    client::VertexArrayName array;
    client::TextureName texture;
    std::vector<Run> runs;
  };
  static Held hold(const MeshPanel& panel);

  client::GlAbilities abilities_;
  client::Program program_;
  std::vector<Held> held_;
};

}  // namespace farfield::bench

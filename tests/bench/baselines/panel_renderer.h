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
  /// Triangles of each uploaded panel within the view's pyramid, as draw() would draw them.
  std::vector<std::size_t> triangles_in_view(const client::ViewTransform& view) const;
  /// What lies outside the view's pyramid is left out, and panels whose `is_shown` is 0 (empty: all are shown). Requires: a
  /// Framebuffer has begun. Returns: triangles drawn.
  std::size_t draw(const client::ViewTransform& view, std::span<const std::uint8_t> is_shown = {});

 private:
  /// Triangles that lie together on a face, and the box around them in (u, v, disparity).
  struct Run {
    std::size_t first_index = 0, count = 0;
    glm::dvec3 low{0}, high{0};
  };
  struct Held {
    std::size_t panel = 0;  // of those uploaded
    ViewFrame frame;
    client::Buffer vertices, indices;
    client::VertexArrayName array;
    client::TextureName texture;
    std::vector<Run> runs;
  };
  /// Where a face's samples stand before the viewer: camera_from_face·(u, v, 1) + disparity·shift, in sides.
  struct Placed {
    glm::dmat3 camera_from_face;
    glm::dvec3 shift;
  };
  static Held hold(const MeshPanel& panel);
  static Placed place(const Held& held, const client::ViewTransform& view);
  static std::vector<Run> runs_in_view(const Held& held, const Placed& placed, const client::ViewTransform& view);

  client::GlAbilities abilities_;
  client::Program program_;
  std::vector<Held> held_;
  std::size_t uploaded_ = 0;
};

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// The shaders that draw scene geometry, in the variants a batch may need.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "client/gl/buffer.h"
#include "client/gl/depth_convention.h"
#include "client/gl/program.h"
#include "client/gl/view_transform.h"
#include "client/near/surface_vertex.h"

namespace farfield::client {

struct SurfaceVariant {
  bool is_textured = false;
  bool is_alpha_masked = false;  // requires a texture

  int index() const { return (is_textured ? 1 : 0) + (is_alpha_masked ? 2 : 0); }
};

/// Alpha of near geometry in the frame target; impostors use one code less. Empty pixels are 0.
inline constexpr std::uint8_t kNearAlpha = 255;

/// All variants are built at once, so that no frame waits for a compiler.
class SurfacePrograms {
 public:
  static Result<SurfacePrograms> build();

  /// Sets what is the same for a whole frame. `frame_centre`: scene position the vertices are relative to.
  void begin_frame(const ViewTransform& view, const glm::dvec3& frame_centre, const DepthConvention& depth);
  /// Selects a variant; `alpha_cutoff` matters for masked ones. The texture is the caller's, on unit 0.
  void use(const SurfaceVariant& variant, float alpha_cutoff);

 private:
  struct Variant {
    Program program;
    int eye = -1, camera_from_frame = -1, inverse_tangents = -1, depth = -1, cutoff = -1;
    bool is_current = false;  // holds this frame's values
  };
  struct FrameValues {
    glm::vec3 eye{0};
    glm::mat3 camera_from_frame{1};
    glm::vec2 inverse_tangents{1}, depth{0};
  };
  std::array<Variant, 4> variants_;
  FrameValues frame_;
};

/// A vertex array that reads SurfaceVertex from `vertices` and 32-bit indices from `indices`.
VertexArrayName make_surface_vertex_array(const Buffer& vertices, const Buffer& indices);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// Draws a leaf set's impostors as textured depth meshes, warped to the exact eye by the vertex shader, into the same
// target and depth buffer as the near geometry (client/gl/depth_convention.h).
//
// Based on: Wilson & Manocha 2003, section 5. Differs: one projection serves all views and faces, disparity 0
// included (view_table.h), and tiles of all views share a few draw calls. Belongs to the context's thread.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "client/gl/gl_context.h"
#include "client/gl/view_transform.h"
#include "client/store/leaf_view.h"

namespace farfield::client {

/// Alpha of impostors in the frame target, one code below near geometry's.
inline constexpr std::uint8_t kImpostorAlpha = 254;

struct ImpostorOptions {
  std::size_t budget_bytes = std::size_t{160} << 20;  // GPU memory, two leaf sets; those in use stay even beyond it
};

struct ImpostorStatistics {
  std::uint64_t triangles = 0;       // sent to the GPU after culling
  std::uint64_t triangles_held = 0;  // of the leaf set
  std::uint32_t draw_calls = 0, tiles_drawn = 0;
  std::uint32_t missing_tiles = 0;  // of the leaf set, not uploaded yet
};

class ImpostorRenderer {
 public:
  /// Compiles its shaders. Errors: kInternal.
  static Result<std::unique_ptr<ImpostorRenderer>> create(const GlAbilities& abilities,
                                                          const ImpostorOptions& options = {});
  ~ImpostorRenderer();

  struct Upload {
    bool is_complete = true;  // the leaf set can be drawn without missing tiles
    std::uint64_t bytes = 0;
    std::uint32_t refused_tiles = 0;
  };
  /// Begins a frame: uploads what the leaf set still lacks, nearest shell first, up to about `frame_upload_bytes`. What is here
  /// of `in_use`, none of them null, stays for this frame to draw, even beyond the budget.
  Upload upload(const LeafView& leaf, std::size_t frame_upload_bytes = std::numeric_limits<std::size_t>::max(),
                std::span<const std::shared_ptr<const LeafView>> in_use = {});

  /// Draws what is uploaded. Requires: a Framebuffer has begun; near geometry comes first, it hides much.
  ImpostorStatistics draw(const LeafView& leaf, const ViewTransform& view);

  std::size_t held_bytes() const;

 private:
  ImpostorRenderer();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield::client

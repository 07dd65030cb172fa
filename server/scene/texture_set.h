// SPDX-License-Identifier: Apache-2.0
// All textures of a scene with their mip chains, and the one look-up that rays shade with.
//
// Texel centres lie at half-integers, (0, 0) is the corner of the first row's first texel, and textures repeat: as in
// OpenGL with GL_REPEAT and GL_LINEAR_MIPMAP_LINEAR on sRGB storage.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "common/base/hash.h"
#include "common/geometry/chunk.h"
#include "server/scene/mip_chain.h"

namespace farfield {

/// Immutable once filled; look-ups are safe from any thread.
class TextureSet {
 public:
  TextureSet();
  /// Cost: about 20 ns per texel. Returns the texture's index.
  std::uint32_t add(const TextureImage& image, const MipOptions& options);

  std::size_t size() const { return textures_.size(); }
  ContentHash hash(std::uint32_t texture) const { return textures_[texture].hash; }
  int level_count(std::uint32_t texture) const { return static_cast<int>(textures_[texture].levels.size()); }
  const MipLevel& level(std::uint32_t texture, int level) const {
    return textures_[texture].levels[static_cast<std::size_t>(level)];
  }
  /// Texels of level 0: what turns an area in uv into an area in texels.
  float texel_count(std::uint32_t texture) const { return textures_[texture].texel_count; }

  /// Linear RGB, bilinear in the two levels around `mip` (>= 0) and linear between them.
  glm::vec3 sample(std::uint32_t texture, const glm::vec2& uv, float mip) const;
  /// Alpha 0 … 1 of level 0, bilinear.
  float sample_alpha(std::uint32_t texture, const glm::vec2& uv) const;
  /// The level in its form for the wire.
  TextureLevel texture_level(std::uint32_t texture, int level) const;
  /// srgb_to_linear as a table.
  const std::array<float, 256>& linear_table() const { return linear_; }

 private:
  struct Texture {
    ContentHash hash = 0;
    float texel_count = 0;
    std::vector<MipLevel> levels;
  };
  glm::vec3 sample_level(const MipLevel& level, const glm::vec2& uv) const;

  std::vector<Texture> textures_;
  std::array<float, 256> linear_;
};

}  // namespace farfield

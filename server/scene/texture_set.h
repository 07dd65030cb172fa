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
#include "common/base/memory_image.h"
#include "common/geometry/chunk.h"
#include "server/scene/mip_chain.h"

namespace farfield {

/// Immutable once filled; look-ups are safe from any thread. Memory: 11 bytes per texel of level 0.
class TextureSet {
 public:
  TextureSet();
  /// Cost: about 20 ns per texel. Returns the texture's index.
  std::uint32_t add(const TextureImage& image, const MipOptions& options);

  /// All of it, as it is in memory.
  void write(MemoryImageWriter& out) const;
  /// Replaces what is here. Any bytes are safe; sizes that do not fit leave `in` invalid.
  void read(MemoryImageReader& in);

  std::size_t size() const { return textures_.size(); }
  ContentHash hash(std::uint32_t texture) const { return textures_[texture].hash; }
  int level_count(std::uint32_t texture) const { return static_cast<int>(textures_[texture].levels.size()); }
  int width(std::uint32_t texture) const { return textures_[texture].levels.front().width; }
  int height(std::uint32_t texture) const { return textures_[texture].levels.front().height; }
  /// Texels of level 0: what turns an area in uv into an area in texels.
  float texel_count(std::uint32_t texture) const { return textures_[texture].texel_count; }

  /// Linear RGB, bilinear in the two levels around `mip` (>= 0) and linear between them.
  glm::vec3 sample(std::uint32_t texture, const glm::vec2& uv, float mip) const;
  /// The mean of sample() at four places.
  glm::vec3 mean_of_four(std::uint32_t texture, const std::array<glm::vec2, 4>& uv, float mip) const;
  /// Alpha 0 … 1 of one texel of level 0. Requires: within the texture.
  float texel_alpha(std::uint32_t texture, int column, int row) const {
    const Level& level = textures_[texture].levels.front();
    return level.texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(column)].a * (1.0f / 65535.0f);
  }
  /// Alpha 0 … 1 of level 0, bilinear.
  float sample_alpha(std::uint32_t texture, const glm::vec2& uv) const;
  /// The level in its form for the wire.
  TextureLevel texture_level(std::uint32_t texture, int level) const;
  /// srgb_to_linear as a table.
  const std::array<float, 256>& linear_table() const { return linear_; }

 private:
  // Linear light × 65535, which is within 3 % of a step of the darkest sRGB codes: decoded once here, since decoding
  // eight texels by table in every look-up took twice as long as the rest of it. Alpha × 257.
  struct alignas(8) Texel {
    std::uint16_t r, g, b, a;
  };
  struct Level {
    int width = 0, height = 0;
    std::vector<Texel> texels;  // rows top to bottom
  };
  struct Texture {
    ContentHash hash = 0;
    float texel_count = 0;
    std::vector<Level> levels;
  };
  struct Lookup;
  struct FourLookups;

  std::vector<Texture> textures_;
  std::array<float, 256> linear_;
};

}  // namespace farfield

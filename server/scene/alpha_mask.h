// SPDX-License-Identifier: Apache-2.0
// Where a texture lets rays through: asked for every triangle of foliage a ray meets, so most answers are one byte.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "server/scene/texture_set.h"

namespace farfield {

/// Immutable; safe from any thread. Memory: a byte per texel of level 0.
class AlphaMask {
 public:
  /// `textures` outlives the mask. O(texels).
  AlphaMask(const TextureSet& textures, std::uint32_t texture, float cutoff);

  /// Whether TextureSet::sample_alpha() is below the cutoff: where the four texels around agree, without asking it.
  bool is_hole(const glm::vec2& uv) const {
    const float u = uv.x - std::floor(uv.x), v = uv.y - std::floor(uv.y);
    // One more than the texel to the upper left, 0 … size: the map has a column and a row more than the texture.
    const auto column = static_cast<std::size_t>(u * static_cast<float>(width_) + 0.5f);
    const auto row = static_cast<std::size_t>(v * static_cast<float>(height_) + 0.5f);
    const Kind kind = kinds_[row * (static_cast<std::size_t>(width_) + 1) + column];
    return kind == Kind::kMixed ? textures_->sample_alpha(texture_, uv) < cutoff_ : kind == Kind::kHole;
  }

 private:
  enum class Kind : std::uint8_t { kSolid, kHole, kMixed };

  const TextureSet* textures_;
  std::uint32_t texture_;
  float cutoff_;
  int width_, height_;
  std::vector<Kind> kinds_;  // of the squares between texel centres, rows top to bottom
};

}  // namespace farfield

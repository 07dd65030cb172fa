// SPDX-License-Identifier: Apache-2.0
// A texture as the rasteriser reads it: all mip levels in one array of words, their light coded so that a square decodes it.
//
//   31 … 21 red, 20 … 10 green, 9 … 0 blue: square roots of linear light (off by at most a sixth of an 8-bit sRGB step)
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/store/leaf_view.h"

namespace farfield::client {

class RasterTexture {
 public:
  static constexpr int kMaxLevels = 13;  // of kMaxTextureEdge

  /// Takes the finest level there is, and the coarser ones that are each half of the one before. O(texels).
  explicit RasterTexture(const DecodedTexture& texture);

  bool is_usable() const { return level_count_ > 0; }
  int width() const { return width_[0]; }
  int height() const { return height_[0]; }
  /// Bilinear, of the finest level, repeated; 0 to 1.
  float alpha_at(float u, float v) const;
  /// Trilinear, repeated, of `count` places, a multiple of 16: multiplies `light`, linear. `texel_area`: of the finest level, that
  /// a pixel covers.
  void multiply(int count, const float* u, const float* v, const float* texel_area, float* const light[3]) const;
  std::size_t memory_bytes() const { return texels_.capacity() * sizeof(std::uint32_t) + alpha_.capacity(); }

 private:
  static constexpr std::size_t kTable = 16;  // one vector
  static_assert(kMaxLevels < kTable);

  int level_count_ = 0;
  alignas(64) std::array<std::int32_t, kTable> width_{}, height_{}, first_{};  // of each level, the finest first; the last stands twice
  std::vector<std::uint32_t> texels_;  // of each level by rows, the first column once more at their ends, and the first row after the last
  std::vector<std::uint8_t> alpha_;  // of the finest level; empty: all opaque
};

}  // namespace farfield::client

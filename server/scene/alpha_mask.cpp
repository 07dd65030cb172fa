// SPDX-License-Identifier: Apache-2.0
#include "server/scene/alpha_mask.h"

namespace farfield {

AlphaMask::AlphaMask(const TextureSet& textures, std::uint32_t texture, float cutoff)
    : textures_(&textures), texture_(texture), cutoff_(cutoff), width_(textures.width(texture)), height_(textures.height(texture)) {
  std::vector<std::uint8_t> is_hole(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      is_hole[static_cast<std::size_t>(y) * width_ + x] = textures.texel_alpha(texture, x, y) < cutoff;
  kinds_.reserve((static_cast<std::size_t>(width_) + 1) * (static_cast<std::size_t>(height_) + 1));
  const auto at = [&](int x, int y) {  // textures repeat
    return is_hole[static_cast<std::size_t>((y + height_) % height_) * width_ + (x + width_) % width_];
  };
  for (int y = -1; y < height_; ++y)
    for (int x = -1; x < width_; ++x) {
      const int holes = at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1);
      kinds_.push_back(holes == 0 ? Kind::kSolid : holes == 4 ? Kind::kHole : Kind::kMixed);
    }
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "client/warp_gl/tile_texels.h"

#include <algorithm>

#include "common/shading/shading.h"

namespace farfield::client {

std::vector<std::uint32_t> texels_of(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha) {
  std::vector<std::uint32_t> texels(alpha.size());
  for (std::size_t i = 0; i < texels.size(); ++i) {
    texels[i] = rgb[3 * i] | (std::uint32_t{rgb[3 * i + 1]} << 8) | (std::uint32_t{rgb[3 * i + 2]} << 16) |
                (std::uint32_t{alpha[i]} << 24);
  }
  return texels;
}

std::vector<std::uint32_t> edge_repeated(std::span<const std::uint32_t> texels, int width, int height, int new_width,
                                         int new_height) {
  std::vector<std::uint32_t> result;
  result.reserve(static_cast<std::size_t>(new_width) * static_cast<std::size_t>(new_height));
  for (int y = 0; y < new_height; ++y) {
    const auto row = texels.subspan(static_cast<std::size_t>(std::min(y, height - 1)) * static_cast<std::size_t>(width),
                                    static_cast<std::size_t>(width));
    result.insert(result.end(), row.begin(), row.end());
    result.insert(result.end(), static_cast<std::size_t>(new_width - width), row.back());
  }
  return result;
}

std::vector<std::uint32_t> half_size(std::span<const std::uint32_t> texels, int width, int height) {
  const auto stride = static_cast<std::size_t>(width);
  std::vector<std::uint32_t> half;
  half.reserve(texels.size() / 4);
  for (std::size_t y = 0; y + 1 < static_cast<std::size_t>(height); y += 2) {
    for (std::size_t x = 0; x + 1 < stride; x += 2) {
      const std::uint32_t* upper = texels.data() + y * stride + x;
      const std::uint32_t* lower = upper + stride;
      std::uint32_t mean = 0;
      for (int shift = 0; shift < 24; shift += 8) {
        const auto linear = [shift](std::uint32_t texel) {
          return srgb_to_linear(static_cast<std::uint8_t>(texel >> shift));
        };
        const float sum = linear(upper[0]) + linear(upper[1]) + linear(lower[0]) + linear(lower[1]);
        mean |= std::uint32_t{linear_to_srgb(0.25f * sum)} << shift;
      }
      half.push_back(mean);
    }
  }
  return half;
}

}  // namespace farfield::client

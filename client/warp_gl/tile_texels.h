// SPDX-License-Identifier: Apache-2.0
// A tile's colours as texture levels. CPU only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace farfield::client {

/// sRGB R, G, B from 3 bytes per texel, and alpha from one. Requires: rgb.size() == 3·alpha.size().
std::vector<std::uint32_t> texels_of(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha);

/// The same image with its last column and row repeated. Requires: new_width >= width, new_height >= height, none 0.
std::vector<std::uint32_t> edge_repeated(std::span<const std::uint32_t> texels, int width, int height, int new_width,
                                         int new_height);

/// The next coarser level: each texel the mean of four in linear light. Requires: even edges.
std::vector<std::uint32_t> half_size(std::span<const std::uint32_t> texels, int width, int height);

}  // namespace farfield::client

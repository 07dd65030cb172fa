// SPDX-License-Identifier: Apache-2.0
// Mip-map chains, filtered in linear light.
//
// Level k+1 has half the edges of level k, rounded down, at least 1, until 1×1. Each texel is the box average of the
// area it covers, whole texels or not, weighted by alpha so that the colour hidden in holes does not bleed out.
#pragma once

#include <cstdint>
#include <vector>

#include "server/model/model.h"

namespace farfield {

struct MipLevel {
  int width = 0, height = 0;
  std::vector<std::uint32_t> texels;  // sRGB R, G, B and alpha from low byte to high, rows top to bottom
};

struct MipOptions {
  bool keeps_alpha = false;   // false: alpha is ignored and becomes opaque
  float alpha_cutoff = 0.5f;  // with keeps_alpha: every level lets the same share of rays through as level 0
  int largest_edge = 4096;    // larger images start at the first halving that fits
};

/// Requires: width, height >= 1 and rgba of that size. Parallel over TBB.
/// Coverage is kept as in: Castaño 2010, "Computing alpha mipmaps".
std::vector<MipLevel> build_mip_chain(const TextureImage& image, const MipOptions& options);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// The orthonormal cosine transform of 8×8 blocks (Ahmed, Natarajan & Rao 1974; DCT-II and its inverse).
//
// Layout: [row][column]. Floats, added in one order and never contracted: every machine gives the same.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "common/impostor/tile_id.h"

namespace farfield {

using BlockPlane = std::array<float, kBlockSamples * kBlockSamples>;

class BlockTransform {
 public:
  BlockTransform() {
    for (int k = 0; k < kBlockSamples; ++k)
      for (int x = 0; x < kBlockSamples; ++x)
        basis_[k][x] = static_cast<float>(std::sqrt((k == 0 ? 1.0 : 2.0) / kBlockSamples) * std::cos(std::numbers::pi * (2 * x + 1) * k / (2 * kBlockSamples)));
  }
  BlockPlane forward(const BlockPlane& samples) const { return transposed_product<false>(transposed_product<false>(samples)); }
  BlockPlane inverse(const BlockPlane& coefficients) const { return transposed_product<true>(transposed_product<true>(coefficients)); }

 private:
  // (B·in)ᵀ, or (Bᵀ·in)ᵀ: one dimension transformed, and the other made ready for the next call. Rows are summed side by side.
  template <bool kInverse>
  BlockPlane transposed_product(const BlockPlane& in) const {
    BlockPlane out;
    for (int k = 0; k < kBlockSamples; ++k) {
      std::array<float, kBlockSamples> sum{};
      for (int x = 0; x < kBlockSamples; ++x) {
        const float factor = kInverse ? basis_[x][k] : basis_[k][x];
        for (int lane = 0; lane < kBlockSamples; ++lane) sum[lane] += factor * in[x * kBlockSamples + lane];
      }
      for (int lane = 0; lane < kBlockSamples; ++lane) out[lane * kBlockSamples + k] = sum[lane];
    }
    return out;
  }

  std::array<std::array<float, kBlockSamples>, kBlockSamples> basis_;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// The orthonormal cosine transform of 8×8 blocks (Ahmed, Natarajan & Rao 1974; DCT-II and its inverse).
//
// Layout: [row][column]. Floats, added in one order and never contracted: every machine gives the same.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "common/impostor/tile_id.h"

namespace farfield {

using BlockPlane = std::array<float, kBlockSamples * kBlockSamples>;

/// A row of a block, all columns at once: as many registers as the machine needs for it.
typedef float BlockRow __attribute__((vector_size(kBlockSamples * sizeof(float))));

// Not returned: how vectors are is a matter of the machine compiled for.
inline void load_row(const float* from, BlockRow& row) { std::memcpy(&row, from, sizeof row); }
inline void store_row(const BlockRow& row, float* to) { std::memcpy(to, &row, sizeof row); }

class BlockTransform {
 public:
  BlockTransform() {
    for (int k = 0; k < kBlockSamples; ++k)
      for (int x = 0; x < kBlockSamples; ++x)
        transposed_[x][k] = basis_[k][x] =
            static_cast<float>(std::sqrt((k == 0 ? 1.0 : 2.0) / kBlockSamples) * std::cos(std::numbers::pi * (2 * x + 1) * k / (2 * kBlockSamples)));
  }
  BlockPlane forward(const BlockPlane& samples) const { return product(basis_, samples, transposed_); }
  BlockPlane inverse(const BlockPlane& coefficients) const { return product(transposed_, coefficients, basis_); }
  /// Each sample of inverse() where all coefficients but the first are zero.
  float inverse_of_mean(float coefficient) const { return basis_[0][0] * coefficient * basis_[0][0]; }

 private:
  using Matrix = std::array<std::array<float, kBlockSamples>, kBlockSamples>;

  // left·in·right: columns first.
  static BlockPlane product(const Matrix& left, const BlockPlane& in, const Matrix& right) {
    BlockRow rows[kBlockSamples], half[kBlockSamples];
    for (int x = 0; x < kBlockSamples; ++x) load_row(&in[x * kBlockSamples], rows[x]);
    for (int row = 0; row < kBlockSamples; ++row) {
      half[row] = BlockRow{};
      for (int x = 0; x < kBlockSamples; ++x) half[row] += left[row][x] * rows[x];
    }
    for (int x = 0; x < kBlockSamples; ++x) load_row(right[x].data(), rows[x]);
    BlockPlane out;
    for (int row = 0; row < kBlockSamples; ++row) {
      BlockRow sum{};
      for (int x = 0; x < kBlockSamples; ++x) sum += half[row][x] * rows[x];
      store_row(sum, &out[row * kBlockSamples]);
    }
    return out;
  }

  Matrix basis_, transposed_;
};

}  // namespace farfield

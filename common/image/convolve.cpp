// SPDX-License-Identifier: Apache-2.0
#include "common/image/convolve.h"

#include <algorithm>

namespace farfield {
namespace {

/// out += weight·in; both plain rows, so that this is one fused SIMD loop.
void accumulate(float weight, const float* __restrict in, float* __restrict out, int count) {
  for (int x = 0; x < count; ++x) out[x] += weight * in[x];
}

}  // namespace

ImageF convolve_rows(const ImageF& in, std::span<const float> kernel) {
  const int radius = static_cast<int>(kernel.size()) / 2;
  ImageF out(in.width, in.height, 1);
  std::vector<float> padded(in.width + 2 * radius);
  for (int y = 0; y < in.height; ++y) {
    const float* row = in.at(0, y);
    std::fill_n(padded.begin(), radius, row[0]);
    std::copy_n(row, in.width, padded.begin() + radius);
    std::fill_n(padded.begin() + radius + in.width, radius, row[in.width - 1]);
    for (std::size_t k = 0; k < kernel.size(); ++k) accumulate(kernel[k], padded.data() + k, out.at(0, y), in.width);
  }
  return out;
}

ImageF convolve_columns(const ImageF& in, std::span<const float> kernel) {
  const int radius = static_cast<int>(kernel.size()) / 2;
  ImageF out(in.width, in.height, 1);
  for (int y = 0; y < in.height; ++y) {
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const int from = std::clamp(y + static_cast<int>(k) - radius, 0, in.height - 1);
      accumulate(kernel[k], in.at(0, from), out.at(0, y), in.width);
    }
  }
  return out;
}

}  // namespace farfield

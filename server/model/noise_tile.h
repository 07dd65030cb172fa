// SPDX-License-Identifier: Apache-2.0
// A square of fractal value noise that repeats without a seam: the grain of generated textures and lawns.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "server/model/random_stream.h"

namespace farfield {

class NoiseTile {
 public:
  static constexpr int kEdge = 256;

  /// Octaves from `coarsest` lattice points per edge upwards, each twice as fine and half as strong. Values in [0, 1].
  explicit NoiseTile(std::uint64_t seed, int coarsest = 8) : values_(kEdge * kEdge, 0.0f) {
    float amplitude = 0.5f, sum = 0;
    for (int lattice = coarsest; lattice <= kEdge; lattice *= 2, amplitude *= 0.5f) {
      add_octave(RandomStream(seed, lattice), lattice, amplitude);
      sum += amplitude;
    }
    for (float& value : values_) value /= sum;
  }

  /// Bilinear look-up; u and v repeat with period 1.
  float at(double u, double v) const {
    const double x = (u - std::floor(u)) * kEdge, y = (v - std::floor(v)) * kEdge;
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    const auto value = [this](int i, int j) {
      return values_[static_cast<std::size_t>((j & (kEdge - 1)) * kEdge + (i & (kEdge - 1)))];
    };
    return (value(x0, y0) * (1 - fx) + value(x0 + 1, y0) * fx) * (1 - fy) +
           (value(x0, y0 + 1) * (1 - fx) + value(x0 + 1, y0 + 1) * fx) * fy;
  }

 private:
  void add_octave(RandomStream random, int lattice, float amplitude) {
    std::vector<float> nodes(static_cast<std::size_t>(lattice) * lattice);
    for (float& node : nodes) node = static_cast<float>(random.unit());
    const auto node = [&](int i, int j) { return nodes[static_cast<std::size_t>((j % lattice) * lattice + i % lattice)]; };
    const int step = kEdge / lattice;
    for (int y = 0; y < kEdge; ++y) {
      for (int x = 0; x < kEdge; ++x) {
        const float tx = static_cast<float>(x % step) / static_cast<float>(step);
        const float ty = static_cast<float>(y % step) / static_cast<float>(step);
        const float sx = tx * tx * (3 - 2 * tx), sy = ty * ty * (3 - 2 * ty);
        const int i = x / step, j = y / step;
        values_[static_cast<std::size_t>(y * kEdge + x)] +=
            amplitude * ((node(i, j) * (1 - sx) + node(i + 1, j) * sx) * (1 - sy) +
                         (node(i, j + 1) * (1 - sx) + node(i + 1, j + 1) * sx) * sy);
      }
    }
  }
  std::vector<float> values_;
};

}  // namespace farfield

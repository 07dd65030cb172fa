// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/fill_uncovered.h"

#include <cstddef>

namespace farfield {

void fill_uncovered(std::vector<std::uint8_t>& rgb, const std::vector<std::uint8_t>& coverage, int width, int height) {
  struct Level {
    int width, height;
    std::vector<float> sum;  // r, g, b, weight
  };
  std::vector<Level> levels;
  Level base{width, height, std::vector<float>(std::size_t{4} * width * height, 0.0f)};
  bool has_holes = false;
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    if (!coverage[i]) {
      has_holes = true;
      continue;
    }
    for (int c = 0; c < 3; ++c) base.sum[4 * i + c] = rgb[3 * i + c];
    base.sum[4 * i + 3] = 1.0f;
  }
  if (!has_holes) return;
  levels.push_back(std::move(base));
  while (levels.back().width > 1 || levels.back().height > 1) {  // pull: averages of what is covered below
    const Level& fine = levels.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.sum.assign(std::size_t{4} * coarse.width * coarse.height, 0.0f);
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        const float* from = &fine.sum[4 * (static_cast<std::size_t>(y) * fine.width + x)];
        float* to = &coarse.sum[4 * (static_cast<std::size_t>(y / 2) * coarse.width + x / 2)];
        for (int c = 0; c < 4; ++c) to[c] += from[c];
      }
    for (std::size_t i = 0; i < coarse.sum.size(); i += 4) {
      const float weight = coarse.sum[i + 3];
      if (weight <= 1.0f) continue;
      for (int c = 0; c < 4; ++c) coarse.sum[i + c] /= weight;
    }
    levels.push_back(std::move(coarse));
  }
  for (std::size_t k = levels.size() - 1; k-- > 0;) {  // push: holes take the value of the level above
    Level& fine = levels[k];
    const Level& coarse = levels[k + 1];
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        float* to = &fine.sum[4 * (static_cast<std::size_t>(y) * fine.width + x)];
        const float weight = to[3];
        if (weight >= 1.0f) continue;
        const float* from = &coarse.sum[4 * (static_cast<std::size_t>(y / 2) * coarse.width + x / 2)];
        for (int c = 0; c < 3; ++c) to[c] += (1.0f - weight) * from[c];
        to[3] = 1.0f;
      }
  }
  for (std::size_t i = 0; i < coverage.size(); ++i)
    if (!coverage[i])
      for (int c = 0; c < 3; ++c) rgb[3 * i + c] = static_cast<std::uint8_t>(levels[0].sum[4 * i + c] + 0.5f);
}

}  // namespace farfield

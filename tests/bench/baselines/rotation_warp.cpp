// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/rotation_warp.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace farfield::bench {

std::vector<std::uint8_t> warp_by_rotation(std::span<const std::uint8_t> picture, const Display& from, const glm::dquat& world_from_picture,
                                           const Display& shown, const glm::dquat& world_from_shown) {
  // Directions are linear in pixel coordinates, so a row is a start and a step, and a division per pixel.
  const glm::dmat3 picture_from_shown(glm::mat3_cast(glm::conjugate(world_from_picture) * world_from_shown));
  const glm::vec3 step(picture_from_shown * (camera_direction(shown, 1, 0) - camera_direction(shown, 0, 0)));
  const auto scale = static_cast<float>(1 / from.pixel_pitch());
  const float middle_x = 0.5f * static_cast<float>(from.width) - 0.5f, middle_y = 0.5f * static_cast<float>(from.height) - 0.5f;
  const auto last_x = static_cast<float>(from.width - 1), last_y = static_cast<float>(from.height - 1);
  std::vector<std::uint8_t> out(std::size_t{3} * shown.width * shown.height);
  tbb::parallel_for(0, shown.height, [&](int y) {
    glm::vec3 direction(picture_from_shown * camera_direction(shown, 0.5, y + 0.5));
    std::uint8_t* pixel = &out[std::size_t{3} * y * shown.width];
    for (int x = 0; x < shown.width; ++x, direction += step, pixel += 3) {
      // Behind the picture's plane there is nothing: far beyond an edge.
      const float inverse = scale / std::max(-direction.z, 1e-6f);
      const float px = std::clamp(middle_x + direction.x * inverse, 0.0f, last_x),
                  py = std::clamp(middle_y - direction.y * inverse, 0.0f, last_y);
      const int x0 = std::min(static_cast<int>(px), from.width - 2), y0 = std::min(static_cast<int>(py), from.height - 2);
      const int fx = static_cast<int>((px - static_cast<float>(x0)) * 256 + 0.5f),
                fy = static_cast<int>((py - static_cast<float>(y0)) * 256 + 0.5f);
      const std::uint8_t* upper = &picture[3 * (static_cast<std::size_t>(y0) * from.width + x0)];
      const std::uint8_t* lower = upper + std::size_t{3} * from.width;
      for (int c = 0; c < 3; ++c) {
        const int top = upper[c] * (256 - fx) + upper[c + 3] * fx, bottom = lower[c] * (256 - fx) + lower[c + 3] * fx;
        pixel[c] = static_cast<std::uint8_t>((top * (256 - fy) + bottom * fy + 32768) >> 16);
      }
    }
  });
  return out;
}

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// Octahedral normals: the unit sphere projected onto an octahedron, its lower half folded outwards onto a square.
#include <algorithm>
#include <cmath>

#include "common/geometry/chunk.h"

namespace farfield {

glm::i16vec2 encode_normal(const glm::vec3& unit_normal) {
  const float length_l1 = std::abs(unit_normal.x) + std::abs(unit_normal.y) + std::abs(unit_normal.z);
  if (!(length_l1 > 0.0f) || !std::isfinite(length_l1)) return {0, 0};
  float x = unit_normal.x / length_l1;
  float y = unit_normal.y / length_l1;
  if (unit_normal.z < 0.0f) {
    const float unfolded_x = x;
    x = (1.0f - std::abs(y)) * (x < 0.0f ? -1.0f : 1.0f);
    y = (1.0f - std::abs(unfolded_x)) * (y < 0.0f ? -1.0f : 1.0f);
  }
  const auto code = [](float value) {
    return static_cast<std::int16_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 32767.0f));
  };
  return {code(x), code(y)};
}

}  // namespace farfield

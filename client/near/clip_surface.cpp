// SPDX-License-Identifier: Apache-2.0
#include "client/near/clip_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace farfield::client {
namespace {

/// One face of the box: what lies at or above `limit` along `axis` is inside; below it, for an upper face.
struct Border {
  int axis = 0;
  float limit = 0;
  bool is_upper = false;

  bool keeps(const SurfaceVertex& v) const {
    return is_upper ? v.position[axis] < limit : v.position[axis] >= limit;
  }
};

using Polygon = std::vector<SurfaceVertex>;

bool comes_before(const SurfaceVertex& a, const SurfaceVertex& b) {
  return std::tie(a.position.x, a.position.y, a.position.z) < std::tie(b.position.x, b.position.y, b.position.z);
}

/// Where an edge with its ends on either side meets the border. The ends are put in order first: rounding must not
/// depend on which triangle asks.
SurfaceVertex meet(const Border& border, SurfaceVertex a, SurfaceVertex b) {
  if (comes_before(b, a)) std::swap(a, b);
  const float from = a.position[border.axis], to = b.position[border.axis];
  const float t = (border.limit - from) / (to - from);
  SurfaceVertex v;
  v.position = glm::mix(a.position, b.position, t);
  v.position[border.axis] = border.limit;
  const glm::vec4 radiance = glm::mix(glm::vec4(a.radiance), glm::vec4(b.radiance), t);
  for (int c = 0; c < 4; ++c) v.radiance[c] = static_cast<std::uint16_t>(std::lround(radiance[c]));
  v.uv = glm::mix(a.uv, b.uv, t);
  return v;
}

/// Sutherland & Hodgman 1974, one border.
void clip(const Border& border, const Polygon& polygon, Polygon& result) {
  result.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const SurfaceVertex &here = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    if (border.keeps(here)) result.push_back(here);
    if (border.keeps(here) != border.keeps(next)) result.push_back(meet(border, here, next));
  }
}

}  // namespace

void clip_surface(const SurfaceBounds& box, std::size_t first_index, std::vector<SurfaceVertex>& vertices,
                  std::vector<std::uint32_t>& indices) {
  std::array<Border, 6> borders;
  for (int axis = 0; axis < 3; ++axis) {
    borders[2 * axis] = {axis, box.min[axis], false};
    borders[2 * axis + 1] = {axis, box.max[axis], true};
  }
  const std::vector<std::uint32_t> whole(indices.begin() + static_cast<std::ptrdiff_t>(first_index), indices.end());
  indices.resize(first_index);
  Polygon polygon, clipped;
  for (std::size_t i = 0; i + 2 < whole.size(); i += 3) {
    polygon = {vertices[whole[i]], vertices[whole[i + 1]], vertices[whole[i + 2]]};
    bool is_whole = true;
    for (const Border& border : borders) {
      if (std::all_of(polygon.begin(), polygon.end(), [&](const SurfaceVertex& v) { return border.keeps(v); })) continue;
      is_whole = false;
      clip(border, polygon, clipped);
      std::swap(polygon, clipped);
      if (polygon.size() < 3) break;
    }
    if (is_whole) {
      indices.insert(indices.end(), {whole[i], whole[i + 1], whole[i + 2]});
      continue;
    }
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (std::uint32_t k = 2; k < polygon.size(); ++k) indices.insert(indices.end(), {first, first + k - 1, first + k});
    if (polygon.size() >= 3) vertices.insert(vertices.end(), polygon.begin(), polygon.end());
  }
}

}  // namespace farfield::client

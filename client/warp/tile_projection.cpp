// SPDX-License-Identifier: Apache-2.0
#include "client/warp/tile_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "client/warp/project_row.h"
#include "common/math/cube_face.h"

namespace farfield::client {

glm::dmat3 pixels_from_directions(const glm::dquat& world_from_camera, const Display& display) {
  const double width = 0.5 * display.width, height = 0.5 * display.height, per_pitch = 1.0 / display.pixel_pitch();
  const glm::dmat3 pixels_from_camera(per_pitch, 0, 0, 0, -per_pitch, 0, -width, -height, -1);
  return pixels_from_camera * glm::transpose(glm::mat3_cast(world_from_camera));
}

TileProjection TileProjection::of(const DecodedTile& tile, const glm::dvec3& eye, const glm::dmat3& pixels) {
  const CubeFace face = CubeFace::of(tile.splats.face);
  TileProjection projection;
  projection.origin = static_cast<double>(face.sign) * pixels[face.axis];
  projection.per_u = pixels[face.u_axis()];
  projection.per_v = pixels[face.v_axis()];
  projection.per_disparity = pixels * ((tile.view_position - eye) / tile.side_m);
  projection.disparity_scale = 1.0 / tile.side_m;
  return projection;
}

namespace {

/// The range of X/w (component 0) or Y/w (1) over the corners; everything where some corner is not in front.
std::array<double, 2> screen_range(const std::array<glm::dvec3, 8>& corners, int component) {
  std::array<double, 2> range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const glm::dvec3& c : corners) {
    if (!(c.z > 0)) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    range[0] = std::min(range[0], c[component] / c.z);
    range[1] = std::max(range[1], c[component] / c.z);
  }
  return range;
}

/// The largest eye disparity of anything drawn between the corners; infinite where some corner is not in front. Splats follow
/// first derivatives at their samples: that puts what truly is at f at f₀ + (f − f₀)·w/w₀.
float nearest_of(const TileProjection& projection, const std::array<glm::dvec3, 8>& corners, float lowest, float highest) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double low = kInfinity, high = -kInfinity, w_low = kInfinity, w_high = 0;
  for (int k = 0; k < 8; ++k) {
    const double w = corners[k].z, disparity = (k & 4 ? highest : lowest) * projection.disparity_scale / w;
    if (!(w > 0)) return std::numeric_limits<float>::infinity();
    low = std::min(low, disparity), high = std::max(high, disparity);
    w_low = std::min(w_low, w), w_high = std::max(w_high, w);
  }
  return static_cast<float>((high + (w_high / w_low - 1) * (high - low)) * (1 + 0x1p-18));  // floats of the samples' own way there
}

/// What of [range] lies within `size` pixels, `margin` added.
void clip(const std::array<double, 2>& range, double margin, double size, int& first, int& last) {
  first = static_cast<int>(std::clamp(std::floor(range[0] - margin), 0.0, size));
  last = static_cast<int>(std::clamp(std::ceil(range[1] + margin), -1.0, size - 1.0));
}

}  // namespace

TileFootprint find_footprint(const TileProjection& projection, const Splats& splats, const Display& display) {
  TileFootprint footprint;
  if (splats.drawn == 0) return footprint;
  const float u_low = splats.u_min - splats.pitch, u_high = splats.u_max + splats.pitch;
  const float v_low = splats.v_min - splats.pitch, v_high = splats.v_max + splats.pitch;
  // Surfaces go on along their slopes as far as the squares say.
  float lowest = splats.min_disparity, highest = splats.max_disparity;
  for (std::size_t k = static_cast<std::size_t>(splats.blocks.rows) * SplatBlocks::kColumns; k < splats.blocks.lowest.size(); ++k)
    lowest = std::min(lowest, splats.blocks.lowest[k]), highest = std::max(highest, splats.blocks.highest[k]);
  std::array<glm::dvec3, 8> corners;
  for (int k = 0; k < 8; ++k) {
    corners[k] = projection.at(k & 1 ? u_high : u_low, k & 2 ? v_high : v_low, k & 4 ? highest : lowest);
  }
  // Outside one side of the frustum, with room for a splat's reach, or behind the eye.
  const double margin = 2 * kMaxReach;  // along both axes of the face
  const auto all = [&](auto&& outside) { return std::all_of(corners.begin(), corners.end(), outside); };
  if (all([&](const glm::dvec3& c) { return !(c.z > 0); }) || all([&](const glm::dvec3& c) { return c.x < -margin * c.z; }) ||
      all([&](const glm::dvec3& c) { return c.x > (display.width + margin) * c.z; }) ||
      all([&](const glm::dvec3& c) { return c.y < -margin * c.z; }) ||
      all([&](const glm::dvec3& c) { return c.y > (display.height + margin) * c.z; })) {
    return footprint;
  }
  clip(screen_range(corners, 1), margin, display.height, footprint.first_row, footprint.last_row);
  clip(screen_range(corners, 0), margin, display.width, footprint.first_column, footprint.last_column);
  footprint.nearest = nearest_of(projection, corners, lowest, highest);
  footprint.is_visible = footprint.first_row <= footprint.last_row && footprint.first_column <= footprint.last_column;
  return footprint;
}

}  // namespace farfield::client

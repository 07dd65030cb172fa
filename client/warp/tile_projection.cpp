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

}  // namespace

TileFootprint find_footprint(const TileProjection& projection, const Splats& splats, const Display& display) {
  TileFootprint footprint;
  if (splats.drawn == 0) return footprint;
  std::array<glm::dvec3, 8> corners;
  for (int k = 0; k < 8; ++k) {
    corners[k] = projection.at(k & 1 ? splats.u_max : splats.u_min, k & 2 ? splats.v_max : splats.v_min,
                               k & 4 ? splats.max_disparity : splats.min_disparity);
  }
  // Outside one side of the frustum, with room for a splat's reach, or behind the eye.
  const double margin = kMaxReach;
  const auto all = [&](auto&& outside) { return std::all_of(corners.begin(), corners.end(), outside); };
  if (all([&](const glm::dvec3& c) { return !(c.z > 0); }) || all([&](const glm::dvec3& c) { return c.x < -margin * c.z; }) ||
      all([&](const glm::dvec3& c) { return c.x > (display.width + margin) * c.z; }) ||
      all([&](const glm::dvec3& c) { return c.y < -margin * c.z; }) ||
      all([&](const glm::dvec3& c) { return c.y > (display.height + margin) * c.z; })) {
    return footprint;
  }
  const auto [top, bottom] = screen_range(corners, 1);
  const double height = display.height;
  footprint.first_row = static_cast<int>(std::clamp(std::floor(top - margin), 0.0, height));
  footprint.last_row = static_cast<int>(std::clamp(std::ceil(bottom + margin), -1.0, height - 1.0));
  footprint.is_visible = footprint.first_row <= footprint.last_row;
  return footprint;
}

}  // namespace farfield::client

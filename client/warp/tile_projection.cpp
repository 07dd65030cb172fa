// SPDX-License-Identifier: Apache-2.0
#include "client/warp/tile_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "client/warp/project_row.h"
#include "common/math/cube_face.h"

namespace farfield::client {

TileProjection TileProjection::of(const DecodedTile& tile, const Pose& eye, const Display& display) {
  const glm::dmat3 camera_from_scene = glm::transpose(glm::mat3_cast(eye.world_from_camera));
  const double per_pitch = 1.0 / display.pixel_pitch();
  const auto to_pixels = [&](const glm::dvec3& direction) {
    const glm::dvec3 q = camera_from_scene * direction;
    return glm::dvec3(-0.5 * display.width * q.z + q.x * per_pitch, -0.5 * display.height * q.z - q.y * per_pitch,
                      -q.z);
  };
  const CubeFace face = CubeFace::of(tile.splats.face);
  const auto axis = [](int k, double length) {
    glm::dvec3 a(0);
    a[k] = length;
    return a;
  };
  TileProjection projection;
  projection.origin = to_pixels(axis(face.axis, face.sign));
  projection.per_u = to_pixels(axis(face.u_axis(), 1));
  projection.per_v = to_pixels(axis(face.v_axis(), 1));
  projection.per_disparity = to_pixels((tile.view_position - eye.position) / tile.side_m);
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
  if (splats.runs.empty()) return footprint;
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

// SPDX-License-Identifier: Apache-2.0
// Procedural tiles for tests of the warper: views of a plane, and single samples.
#pragma once

#include <cmath>
#include <memory>

#include "client/store/leaf_view.h"
#include "common/math/camera.h"
#include "common/math/cube_face.h"

namespace farfield::client {

inline constexpr int kMinusZ = 5;  // u is +x and v is +y there, as a camera with the identity rotation sees them

/// Links and reaches for an array of width × height samples, all of one surface up to its border.
inline void connect_grid(Splats& s, int width, int height) {
  s.reach.clear(), s.links.clear();
  const auto row = static_cast<std::uint16_t>(width);
  for (int j = 0; j < height; ++j) {
    const auto first = static_cast<std::uint32_t>(j * width);
    s.links.push_back({first, j > 0 ? row : std::uint16_t{0}, j + 1 < height ? row : std::uint16_t{0}});
    for (int i = 0; i < width; ++i) {
      const auto side = [](bool connected) { return connected ? kReachConnected : kReachToNothing; };
      s.reach.push_back(pack_reach(side(i > 0), side(i + 1 < width), side(j > 0), side(j + 1 < height)));
    }
  }
  s.drawn = static_cast<std::uint32_t>(s.size());
}

/// One whole face of `edge_samples`² samples of the plane z = -distance, seen from `view`; colour(x, y) is 0x00BBGGRR.
template <class Colour>
std::shared_ptr<DecodedTile> plane_tile(const glm::dvec3& view, double side_m, double distance, int edge_samples,
                                        Colour&& colour) {
  auto tile = std::make_shared<DecodedTile>();
  tile->view_position = view;
  tile->side_m = side_m;
  Splats& s = tile->splats;
  s.face = kMinusZ;
  s.pitch = static_cast<float>(sample_pitch(edge_samples));
  const double z = distance + view.z;
  for (int j = 0; j < edge_samples; ++j) {
    const double v = sample_tangent(edge_samples, j);
    s.runs.push_back({static_cast<float>(sample_tangent(edge_samples, 0)), static_cast<float>(v),
                      static_cast<std::uint32_t>(s.disparity.size()), static_cast<std::uint32_t>(edge_samples)});
    for (int i = 0; i < edge_samples; ++i) {
      const double u = sample_tangent(edge_samples, i);
      s.disparity.push_back(static_cast<float>(side_m / z));
      s.colour.push_back(colour(view.x + u * z, view.y + v * z));
    }
  }
  connect_grid(s, edge_samples, edge_samples);
  s.min_disparity = s.max_disparity = static_cast<float>(side_m / z);
  s.u_min = s.v_min = static_cast<float>(sample_tangent(edge_samples, 0));
  s.u_max = s.v_max = static_cast<float>(sample_tangent(edge_samples, edge_samples - 1));
  s.blocks = find_blocks(s);
  return tile;
}

/// A square of pitch² in tangent units round (u, v).
inline std::shared_ptr<DecodedTile> single_sample(const glm::dvec3& view, double side_m, int face, float u, float v,
                                                  float disparity, std::uint32_t colour, float pitch) {
  auto tile = std::make_shared<DecodedTile>();
  tile->view_position = view;
  tile->side_m = side_m;
  Splats& s = tile->splats;
  s.face = face;
  s.pitch = pitch;
  s.runs.push_back({u, v, 0, 1});
  s.disparity = {disparity};
  s.colour = {colour};
  s.links = {{}};
  s.drawn = 1;
  s.reach = {kReachHalfway};
  s.min_disparity = s.max_disparity = disparity;
  s.u_min = s.u_max = u;
  s.v_min = s.v_max = v;
  s.blocks = find_blocks(s);
  return tile;
}

inline LeafView leaf_of(std::vector<std::shared_ptr<const DecodedTile>> tiles) {
  LeafView leaf;
  leaf.is_complete = true;
  leaf.background = {1, 2, 3};
  leaf.tiles = std::move(tiles);
  return leaf;
}

/// The display whose pixels are the samples of a face with `edge_samples`, cut to width × height.
inline Display display_on_samples(int edge_samples, int width, int height) {
  Display display;
  display.width = width;
  display.height = height;
  display.fovy_rad = 2.0 * std::atan(0.5 * height * sample_pitch(edge_samples));
  return display;
}

}  // namespace farfield::client

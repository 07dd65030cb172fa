// SPDX-License-Identifier: Apache-2.0
// A triangle of near geometry, ready to be drawn: which pixels it covers and how near it is there.
//
// With corners a, b, c in (X, Y, w), see client/warp/tile_projection.h, b×c, c×a and a×b are linear functions of the pixel (x, y, 1) that
// are not negative inside, once divided by a·(b×c). Weighted by an attribute's values at the corners their sum is the
// attribute over w, and 1/w for the attribute 1. Nothing is clipped at the eye's plane: behind it 1/w is negative. Triangles
// with an edge in common compute it with the same numbers but for the sign, so no pixel falls between them.
//
// Based on: Olano & Greer 1997 (triangle scan conversion using 2D homogeneous coordinates).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "client/near/surface_vertex.h"
#include "client/near_cpu/raster_texture.h"

namespace farfield::client {

/// A function of the pixel's column and row, counted from the frame's first.
struct PixelLinear {
  double origin = 0, along_x = 0, along_y = 0;
  double row(int y) const { return origin + along_y * y; }
};

struct RasterTriangle {
  int left = 0, right = -1, top = 0, bottom = -1;  // pixels it may cover, within the frame
  std::array<PixelLinear, 3> edges;                // none is negative where it covers a pixel's centre
  std::array<double, 3> zero, zero_per_row;        // the column where an edge is zero, in row 0, and per row
  PixelLinear disparity;                           // 1/w, per metre
  std::array<PixelLinear, 3> radiance;             // linear light over w
  PixelLinear u, v;                                // over w
  bool has_one_colour = false;
  std::uint32_t colour = 0;                        // then: 0x00BBGGRR
  const RasterTexture* texture = nullptr;          // null: none
  bool is_alpha_masked = false;
  float alpha_cutoff = 0;
};

/// One corner: its place and what is interpolated.
struct RasterCorner {
  glm::dvec3 place{0};  // (X, Y, w)
  const SurfaceVertex* vertex = nullptr;
};

/// Sets all but texture and mask. Returns: false if no pixel of the frame can show it up to `largest_disparity`.
bool place_triangle(const std::array<RasterCorner, 3>& corners, float largest_disparity, int width, int height, RasterTriangle& out);

/// Writes into rows [first_row, last_row) of the frame whose keys are given the larger of what is there and key_high() of the
/// triangle's disparity with `number` below it, wherever it covers a pixel's centre up to `largest_disparity`. Of equal disparities
/// the larger number stays.
void draw_triangle(const RasterTriangle& triangle, std::uint32_t number, float largest_disparity, int first_row, int last_row, int width,
                   std::uint64_t* keys);

}  // namespace farfield::client

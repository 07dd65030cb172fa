// SPDX-License-Identifier: Apache-2.0
// The depth-mesh form of a tile: its samples as textured triangles in (u, v, disparity), cut at skins, with quads
// merged by a quadtree wherever disparity is planar within a tolerance, then simplified. Planes of the scene are exactly
// planar there.
//
// Based on: Wilson & Manocha 2003, section 4; quadtree merging after the disparity planes of design.md section 3.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/tile.h"

namespace farfield {

struct DepthMeshVertex {
  float u = 0, v = 0;            // tangent coordinates on the face
  float disparity = 0;           // 1/(cell side)
  float column = 0, row = 0;     // texture position in samples, texel centres at +0.5
};

/// Where surfaces end between a texel and its right and lower neighbours, as in Tile: in eighths, 0 where they go on.
inline constexpr std::uint8_t pack_cuts(std::uint8_t right, std::uint8_t down) {
  return static_cast<std::uint8_t>((right & 15) | (down & 15) << 4);
}

struct DepthMesh {
  int face = 0;
  int width = 0, height = 0;             // of the texture
  bool has_gaps = false;                 // some texels mean nothing: no mip levels can be made of it
  std::vector<std::uint8_t> rgb;         // sRGB, 3 bytes per texel
  std::vector<std::uint8_t> cuts;        // per texel pack_cuts(): colours must not be mixed across them
  std::vector<DepthMeshVertex> vertices;
  std::vector<std::uint32_t> indices;    // three per triangle; both sides count as front
};

/// `tolerance`: the |disparity| error that merging and simplifying aim at, 1/(cell side); at samples inside one surface
/// they add at most kWorstOverTolerance times that, and outlines move by about kOutlineSamples (simplify_mesh.h). 0 keeps one quad per sample pair and outlines where they are.
/// No T-junctions within a tile. Cut edges end at their recorded eighth, extrapolated in the plane of the surface they
/// belong to. A packed tile's texture shows its blocks as they stand on the face; one whose blocks do not lie within
/// one region, which no decoder returns, is left empty.
/// O(samples), and O(n log n) in what merging leaves.
DepthMesh build_depth_mesh(const Tile& tile, float tolerance);

}  // namespace farfield

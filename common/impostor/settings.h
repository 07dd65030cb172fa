// SPDX-License-Identifier: Apache-2.0
// Everything that decides what a cell's impostor contains. Its hash, with the scene's, is part of every cache key.
#pragma once

#include <cstdint>

#include "common/base/hash.h"
#include "common/impostor/tile_id.h"
#include "common/math/camera.h"

namespace farfield {

struct ImpostorSettings {
  double finest_side_m = 0.5;        // side of a level-0 cell: the floor of subdivision
  double kappa = 2.0;                // margin of the near region, in sides
  int face_tiles = 12;               // tiles along a face's edge; face_samples(12) = 1514 suits 720p at 60 degrees
  double tau_px = 0.25;              // guaranteed warp error of coded disparity, in pixels of `display`
  Display display;                   // what tau and the sample rate are meant for
  std::uint32_t near_triangles = 20000;  // P: the geometry budget
  int delta_views = 8;               // at most
  double void_target = 6e-5;         // stop adding delta views below this share of the sphere
  int jpeg_quality = 88;

  int edge_samples() const { return face_samples(face_tiles); }
  ContentHash hash() const;
};

}  // namespace farfield

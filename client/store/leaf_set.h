// SPDX-License-Identifier: Apache-2.0
// What the server says a leaf set consists of, checked and in our own words, and the frame it lives in.
#pragma once

#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <vector>

#include "common/impostor/direction_mask.h"
#include "common/impostor/enclosure_mask.h"
#include "common/base/hash.h"
#include "common/cells/cell_id.h"

namespace farfield::client {

/// What the client needs to know of a scene to place leaf sets in it. Scene frame: metres relative to its origin.
struct SceneFrame {
  CellGrid grid;
  double kappa = 2.0;              // margin of the near region, in sides
  glm::u8vec3 background{0};       // sRGB
};

struct LeafSetChunk {
  ContentHash chunk = 0;
  ContentHash texture = 0;         // 0: none
  glm::mat4x3 cell_from_chunk{1};  // metres relative to the leaf's centre
};

struct LeafSet {
  std::uint64_t serial = 0;
  CellId leaf;
  CellId root;
  EnclosureMask enclosure;         // where in the leaf the set holds
  bool is_current = false;         // false: prefetched
  bool is_fallback = false;
  bool background_visible = true;
  DirectionMask sky = DirectionMask::all();
  std::uint32_t near_triangles = 0;
  std::vector<ContentHash> tiles;  // in order of use: nearest shell first
  std::vector<LeafSetChunk> chunks;
};

}  // namespace farfield::client

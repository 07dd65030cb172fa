// SPDX-License-Identifier: Apache-2.0
// What the renderers draw: one leaf set, decoded, immutable. The client core hands one out for every frame.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "common/cells/cell_id.h"
#include "common/geometry/chunk.h"
#include "common/impostor/direction_mask.h"
#include "common/impostor/enclosure_mask.h"
#include "common/impostor/packed_mesh.h"
#include "common/impostor/splats.h"
#include "common/impostor/tile.h"

namespace farfield::client {

/// A decoded tile in the form its renderer needs; the other is empty. `serial` never repeats within a process: GL
/// objects are cached under it.
struct DecodedTile {
  TileId id;
  std::uint64_t serial = 0;
  glm::dvec3 view_position{0};   // scene frame
  double side_m = 1;             // of the cell: disparities are in 1/side
  float tolerance = 0;           // guaranteed disparity error, 1/side
  PackedMesh mesh;               // with its texture: for the GL renderer
  Splats splats;                 // for the CPU warper
  int edge_samples = 0;          // along its view's face
  std::uint32_t covered_samples = 0;
  Certificate certificate;
  std::size_t memory_bytes = 0;
};

struct DecodedChunk {
  ContentHash hash = 0;
  std::uint64_t serial = 0;
  Chunk chunk;
};

struct DecodedTexture {
  ContentHash hash = 0;
  std::uint64_t serial = 0;               // changes when a finer level arrives
  std::vector<TextureLevel> levels;       // coarsest first; what has arrived so far
};

struct PlacedChunk {
  std::shared_ptr<const DecodedChunk> chunk;
  std::shared_ptr<const DecodedTexture> texture;  // null: none, or not arrived yet
  glm::mat4x3 cell_from_chunk{1};                 // metres relative to the leaf's centre
};

struct LeafView {
  CellId leaf;
  Box leaf_box;                    // scene frame
  EnclosureMask enclosure;         // where in the leaf the view holds
  Box near_region;                 // scene frame; chunks are cut here per fragment
  bool is_fallback = false;        // the fallback view: near_region is NestedShells::fallback_region()
  bool is_complete = false;
  bool background_visible = true;  // false: a pixel nothing covers is a void, never sky
  DirectionMask sky = DirectionMask::all();  // and where else it may be sky
  glm::u8vec3 background{0};       // sRGB
  std::vector<std::shared_ptr<const DecodedTile>> tiles;
  std::vector<PlacedChunk> chunks;

  /// Whether it shows all that can be seen from `eye` (scene frame), once complete.
  bool speaks_for(const glm::dvec3& eye) const { return leaf_box.contains(eye) && enclosure.contains(leaf_box, eye); }
  /// Another state of the same leaf set.
  bool is_same_set(const LeafView& other) const {
    return leaf == other.leaf && is_fallback == other.is_fallback && enclosure == other.enclosure;
  }
};

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// Static levels of detail of one mesh: trees whose leaves are the mesh's chunks and whose inner nodes are simplified
// versions of all below them. Any cut through the trees draws the whole mesh once, without cracks.
//
// Based on: Luebke et al., "Level of Detail for 3D Graphics", 2003, section 4.3 (hierarchical, chunked levels of
// detail) and Cignoni et al., "Batched Multi Triangulation", 2005: groups of neighbouring chunks are merged and simplified
// with every position kept that other groups use too, so that neighbours of any level fit; the next level merges groups,
// which frees what was between them. Where the mesh itself ends it may be simplified. Simplification is meshoptimizer's, by edge collapse
// and quadric error (Garland & Heckbert 1997); version 0.18 keeps attributes by keeping vertices: seams of colour, normal or texture
// collapse only along themselves. Differs: a group that hardly gets smaller is left out, and its parts stay roots.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "client/near/surface_vertex.h"

namespace farfield::bench {

struct LodNode {
  glm::vec3 min{0}, max{0};  // bounds of all below it, metres in the frame of the vertices
  float error_m = 0;         // how far its surface may lie from the chunks': meshoptimizer's estimates added up the tree, so no
                             // smaller than any child's; 0 for chunks
  std::uint32_t first_index = 0, index_count = 0;
  std::uint32_t first_child = 0, child_count = 0;  // children are consecutive nodes; none: a chunk
};

struct LodForest {
  std::vector<client::SurfaceVertex> vertices;  // all levels', shared
  std::vector<std::uint32_t> indices;           // of all nodes
  std::vector<LodNode> nodes;                   // children before parents
  std::vector<std::uint32_t> roots;
};

/// Where the mesh meets others: positions that must stay.
using IsFixed = std::function<bool(const glm::vec3& position)>;

/// `chunk_ends`: where each chunk's indices end; neighbouring chunks should be close in space. Equal vertices are made one.
/// Cost: about a second per million triangles and thread, on all TBB workers of the calling arena.
LodForest build_lod_forest(std::span<const client::SurfaceVertex> vertices, std::span<const std::uint32_t> indices,
                           std::span<const std::uint32_t> chunk_ends, const IsFixed& is_fixed);

/// Emits the coarsest nodes whose error, seen from `eye` at the nearest point of their bounds, stays within
/// `error_per_metre` (metres at one metre's distance: pixels times the pixel pitch). `may_see` culls whole trees.
void select_lods(const LodForest& forest, const glm::vec3& eye, float error_per_metre, const std::function<bool(const LodNode&)>& may_see,
                 const std::function<void(const LodNode&)>& emit);

}  // namespace farfield::bench

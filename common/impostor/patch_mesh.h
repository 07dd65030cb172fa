// SPDX-License-Identifier: Apache-2.0
// Turns one patch, divided into rectangles, into the triangles of a depth mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/depth_mesh.h"
#include "common/impostor/planar_merge.h"
#include "common/impostor/surface_patch.h"

namespace farfield {

/// Where a patch's sample (0, 0) stands: on the face, in samples of an edge with `edge_samples`, and in the texture.
struct PatchPlace {
  int edge_samples = 0;
  int face_x = 0, face_y = 0;
  int texel_x = 0, texel_y = 0;
};

/// Sets used[sample] to 1 at the corners of all rectangles. Vertices shared by patches must be marked in all of them
/// before any is drawn, so that their meshes meet without T-junctions.
void mark_used_vertices(const SurfacePatch& patch, const std::vector<QuadRect>& rects, std::vector<std::uint8_t>& used);

/// Keeps its tables between patches. One thread at a time.
class PatchMesher {
 public:
  explicit PatchMesher(DepthMesh& mesh) : mesh_(mesh) {}

  /// Appends the triangles of `rects` to the mesh. `merge` must be prepared with the same patch.
  void draw(const SurfacePatch& patch, const PatchPlace& place, const PlanarMerge& merge,
            const std::vector<QuadRect>& rects, const std::vector<std::uint8_t>& used);

 private:
  void draw_plain_quad(int x, int y);
  void draw_merged(const QuadRect& rect, const PlanarMerge& merge, const std::vector<std::uint8_t>& used);
  void draw_cut_quad(int x, int y);
  std::uint32_t sample_vertex(int x, int y);
  std::uint32_t add_vertex(double x, double y, float disparity);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  DepthMesh& mesh_;
  SurfacePatch patch_;
  PatchPlace place_;
  std::vector<std::uint32_t> vertex_of_;  // by sample; kNoVertex where none was made yet
  std::vector<std::uint32_t> border_;     // of the rectangle being drawn
};

}  // namespace farfield

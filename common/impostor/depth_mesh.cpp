// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/depth_mesh.h"

#include "common/impostor/fill_uncovered.h"
#include "common/impostor/patch_mesh.h"
#include "common/impostor/simplify_mesh.h"
#include "common/impostor/unpacked_blocks.h"

namespace farfield {
namespace {

void mesh_patch(const SurfacePatch& patch, const PatchPlace& place, float tolerance, DepthMesh& mesh) {
  std::vector<QuadKind> kinds;
  classify_quads(patch, kinds);
  PlanarMerge merge;
  merge.prepare(patch, kinds, tolerance);  // merging planes first makes simplifying cheap
  std::vector<QuadRect> rects;
  merge.divide({0, 0, static_cast<std::int16_t>(patch.width - 1), static_cast<std::int16_t>(patch.height - 1)}, rects);
  std::vector<std::uint8_t> used;
  mark_used_vertices(patch, rects, used);
  PatchMesher(mesh).draw(patch, place, merge, rects, used);
  if (tolerance > 0) simplify_mesh(patch, place, tolerance, mesh);
}

/// Of the patch's samples from (border, border) on, one per texel.
void take_cuts(const SurfacePatch& patch, int border, DepthMesh& mesh) {
  mesh.cuts.reserve(mesh.rgb.size() / 3);
  for (int y = 0; y < mesh.height; ++y) {
    for (int x = 0; x < mesh.width; ++x) {
      const std::size_t at = patch.at(x + border, y + border);
      mesh.cuts.push_back(pack_cuts(patch.cut_right[at], patch.cut_down[at]));
    }
  }
}

void mesh_dense(const Tile& tile, float tolerance, DepthMesh& mesh) {
  mesh.width = tile.width;
  mesh.height = tile.height;
  mesh.rgb = tile.rgb;
  fill_uncovered(mesh.rgb, tile.coverage, tile.width, tile.height);
  const SurfacePatch patch{tile.width,           tile.height,           tile.coverage.data(),
                           tile.disparity.data(), tile.cut_right.data(), tile.cut_down.data()};
  take_cuts(patch, 0, mesh);
  if (tile.width < 2 || tile.height < 2) return;
  mesh_patch(patch, {tile.edge_samples, tile.id.x * kTileStride, tile.id.y * kTileStride, 0, 0}, tolerance, mesh);
}

void mesh_packed(const Tile& tile, float tolerance, DepthMesh& mesh) {
  mesh.has_gaps = true;
  if (tile.blocks.empty() || !is_one_region(tile)) return;
  std::vector<std::uint8_t> rgb = tile.rgb;
  fill_uncovered(rgb, tile.coverage, tile.width, tile.height);
  UnpackedBlocks blocks = unpack_blocks(tile, rgb);
  mesh.width = blocks.width - 2;
  mesh.height = blocks.height - 2;
  mesh.rgb = std::move(blocks.rgb);
  take_cuts(blocks.patch(), 1, mesh);
  mesh_patch(blocks.patch(), {tile.edge_samples, blocks.face_x, blocks.face_y, -1, -1}, tolerance, mesh);
}

}  // namespace

DepthMesh build_depth_mesh(const Tile& tile, float tolerance) {
  DepthMesh mesh;
  mesh.face = tile.id.face;
  if (tile.is_packed()) {
    mesh_packed(tile, tolerance, mesh);
  } else {
    mesh_dense(tile, tolerance, mesh);
  }
  return mesh;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/depth_mesh.h"

#include "common/impostor/block_window.h"
#include "common/impostor/patch_mesh.h"

namespace farfield {
namespace {

void mesh_dense(const Tile& tile, float tolerance, DepthMesh& mesh) {
  mesh.width = tile.width;
  mesh.height = tile.height;
  mesh.rgb = tile.rgb;
  if (tile.width < 2 || tile.height < 2) return;

  const SurfacePatch patch{tile.width,           tile.height,           tile.coverage.data(),
                           tile.disparity.data(), tile.cut_right.data(), tile.cut_down.data()};
  std::vector<QuadKind> kinds;
  classify_quads(patch, kinds);
  PlanarMerge merge;
  merge.prepare(patch, kinds, tolerance);
  std::vector<QuadRect> rects;
  merge.divide({0, 0, static_cast<std::int16_t>(tile.width - 1), static_cast<std::int16_t>(tile.height - 1)}, rects);
  std::vector<std::uint8_t> used;
  mark_used_vertices(patch, rects, used);
  const PatchPlace place{tile.edge_samples, tile.id.x * kTileStride, tile.id.y * kTileStride, 0, 0};
  PatchMesher(mesh).draw(patch, place, merge, rects, used);
}

/// What is drawn of one block's window: its own 8×8 quads, merged where planar, and those towards missing neighbours.
void divide_window(const PlanarMerge& merge, std::vector<QuadRect>& rects) {
  rects.clear();
  for (std::int16_t k = 0; k <= kBlockSamples; ++k) {
    merge.divide({k, 0, static_cast<std::int16_t>(k + 1), 1}, rects);
    if (k > 0) merge.divide({0, k, 1, static_cast<std::int16_t>(k + 1)}, rects);
  }
  merge.divide({1, 1, kBlockSamples + 1, kBlockSamples + 1}, rects);
}

void mesh_packed(const Tile& tile, float tolerance, DepthMesh& mesh) {
  const BlockMap map(tile);
  BlockWindow window;
  PlanarMerge merge;
  std::vector<QuadKind> kinds;
  std::vector<QuadRect> rects;
  std::vector<std::uint8_t> used, tile_used(tile.samples(), 0);
  const auto prepare = [&](std::size_t block) {
    window.load(tile, map, block);
    classify_quads(window.patch(), kinds);
    window.leave_to_neighbours(kinds);
    merge.prepare(window.patch(), kinds, tolerance);
    divide_window(merge, rects);
  };

  // All blocks must say which samples they use as vertices before any is drawn.
  for (std::size_t block = 0; block < tile.blocks.size(); ++block) {
    prepare(block);
    used.assign(kWindowSamples * kWindowSamples, 0);
    mark_used_vertices(window.patch(), rects, used);
    window.store_used(used, tile_used);
  }
  const int rows = static_cast<int>((tile.blocks.size() + kPackedColumns - 1) / kPackedColumns);
  mesh.width = kPackedColumns * kWindowSamples;
  mesh.height = rows * kWindowSamples;
  mesh.rgb.assign(static_cast<std::size_t>(3) * mesh.width * mesh.height, 0);
  PatchMesher mesher(mesh);
  for (std::size_t block = 0; block < tile.blocks.size(); ++block) {
    prepare(block);
    window.load_used(tile_used, used);
    const int texel_x = static_cast<int>(block % kPackedColumns) * kWindowSamples;
    const int texel_y = static_cast<int>(block / kPackedColumns) * kWindowSamples;
    window.copy_texels(tile, mesh.rgb.data() + 3 * (static_cast<std::size_t>(texel_y) * mesh.width + texel_x),
                       mesh.width);
    const PatchPlace place{tile.edge_samples, tile.blocks[block].x * kBlockSamples - 1,
                           tile.blocks[block].y * kBlockSamples - 1, texel_x, texel_y};
    mesher.draw(window.patch(), place, merge, rects, used);
  }
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

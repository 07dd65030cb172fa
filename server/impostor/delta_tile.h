// SPDX-License-Identifier: Apache-2.0
// A tile of a delta view: only what no earlier view of the shell holds.
//
// Based on: Wilson & Manocha 2003, section 4.1 (incremental meshes, redundant samples dropped within an epsilon that
// grows with distance). Differs: whether an earlier view holds a surface point is asked of the scene (is the segment
// between them free?), not of that view's samples, so a tile depends on no other tile and can be made alone.
#pragma once

#include "server/impostor/dense_tile.h"

namespace farfield {

struct DeltaSkips {
  std::size_t blocks_probed = 0, blocks_cast = 0;   // of blocks without a void nothing is cast
  std::size_t samples_held = 0;                     // cast, but redundant
};

/// `views`: the shell's views; the tile belongs to views[id.view]. A sparse probe, one ray for each patch of 4×4 samples and two more beside rims,
/// finds voids; these patches are cast whole, and so are those beside them that their voids reach into. Samples that an
/// earlier view holds at no less than a third of this one's resolution are dropped, except for a one-sample border that
/// meets the held surface.
/// `visible`: blocks outside it are neither probed nor cast; null: all may be.
/// Returns: a packed tile, without blocks if nothing is missing.
Tile cast_delta_tile(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, const TileId& id,
                     const ImpostorSettings& settings, double warp_gain, double tolerance, const VisibleBlocks* visible, TileWork& work,
                     DeltaSkips& skips);

}  // namespace farfield

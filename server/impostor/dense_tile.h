// SPDX-License-Identifier: Apache-2.0
// A tile of an intra or fallback view: all samples cast.
#pragma once

#include "server/impostor/connectivity.h"
#include "server/impostor/stage_seconds.h"
#include "server/impostor/visible_blocks.h"

namespace farfield {

struct TileWork {
  StageSeconds seconds;
  std::size_t rays = 0;
  std::size_t samples_refined = 0;  // covered, coloured from several look-ups or rays …
  std::size_t samples_coloured_once = 0;  // … and those that look like their neighbours or are smoothed by their texture's filter

  void count_colours(const Tile& tile, const SampleArrays& samples) {
    for (std::size_t at = 0; at < tile.samples(); ++at)
      if (tile.coverage[at]) ++(samples.refined[at] ? samples_refined : samples_coloured_once);
  }
};

/// Returns: the tile without certificate; covered nowhere if the shell holds nothing there.
/// `visible`: samples outside it are not cast; null: all are.
/// Requires: id names a tile of a dense view; `tolerance` in 1/side.
Tile cast_dense_tile(const Scene& scene, const CellSpace& space, const glm::dvec3& view, const TileId& id, int edge_samples,
                     double warp_gain, double tolerance, const VisibleBlocks* visible, TileWork& work);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Which tiles of a cell's own shell its leaves need: of a leaf what its plan lists, of an inner cell what each of its leaves is
// likely to, without finding these.
#pragma once

#include "server/cells/cell_tree.h"
#include "server/impostor/shell_views.h"

namespace farfield {

struct CellNeed {
  TileId id;
  float view_share = 0;  // of the sphere of directions, as NeededTile's: mean over those who need the tile
  float leaf_share = 1;  // of the cell's leaves: how many need it
};

/// In the order of their names. Of inner cells the eighths in which somebody can stand are looked at as if they were leaves: three
/// quarters of a million rays. Deterministic: depends on scene, settings and cell only. Errors: kCancelled.
Result<std::vector<CellNeed>> cell_needs(const Scene& scene, CellTree& tree, const CellSpace& space, const std::shared_ptr<const ShellViews>& views,
                                         const ImpostorSettings& settings, const CancelFlag& cancel);

}  // namespace farfield

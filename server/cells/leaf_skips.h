// SPDX-License-Identifier: Apache-2.0
// What planning a leaf left out because nobody in it needs it, with the reason for each.
#pragma once

#include <cstdint>

namespace farfield {

/// Of one leaf, or summed up. Tiles are those of all views of the leaf's shells that were asked for, and of the first view of
/// the shells of which nothing is seen.
struct LeafSkips {
  std::uint64_t tiles_unseen = 0;         // no ray from the leaf meets anything in them
  std::uint64_t tiles_too_small = 0;      // some do, in less of the view than is worth a tile's bytes
  std::uint64_t chunks_facing_away = 0;   // of the near region: from everywhere in the leaf, and unseen
  std::uint64_t chunks_unseen = 0;        // of the near region: no ray from the leaf reaches them
  std::uint64_t triangles_unseen = 0;     // of all these chunks
  std::uint64_t blocked_cells = 0;        // nobody can stand in them: probed and viewed no further than one view needs

  LeafSkips& operator+=(const LeafSkips& other) {
    tiles_unseen += other.tiles_unseen, tiles_too_small += other.tiles_too_small;
    chunks_facing_away += other.chunks_facing_away, chunks_unseen += other.chunks_unseen, triangles_unseen += other.triangles_unseen;
    blocked_cells += other.blocked_cells;
    return *this;
  }
};

/// Since start, over all leaves planned and all shells whose views were chosen.
struct PlanSkips : LeafSkips {
  std::uint64_t delta_views_unneeded = 0;  // allowed, and not made: the voids left were below the target before
};

}  // namespace farfield

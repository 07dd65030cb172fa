// SPDX-License-Identifier: Apache-2.0
// What a viewer standing in one leaf cell needs: the tiles of the leaf's and its ancestors' shells that some viewpoint
// of the leaf can see, and the near geometry. Or, until that is known and made, the fallback view of a cell around them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/base/result.h"
#include "common/cells/cell_id.h"
#include "common/impostor/direction_mask.h"
#include "common/impostor/enclosure_mask.h"
#include "common/impostor/tile_id.h"
#include "server/cells/leaf_skips.h"

namespace farfield {

struct NeededTile {
  TileId id;
  float view_share = 0;  // of the sphere of directions seen from the leaf: what sending it first is worth
};

struct LeafPlan {
  CellId leaf;                          // of a fallback view: the cell it is made for, which need not be a leaf
  bool is_fallback = false;
  CellId root;                          // the last ancestor whose shell holds anything but background
  std::vector<NeededTile> tiles;        // sorted by descending view_share within each shell, nearest shell first
  std::vector<std::uint32_t> chunks;    // indices into Scene::chunks(), sorted by ascending distance
  std::uint32_t near_triangles = 0;     // of those chunks
  bool exceeds_budget = false;          // at the finest side and still above the geometry budget
  bool background_visible = false;      // some ray from the leaf escapes the scene …
  DirectionMask sky;                    // … in these directions
  double seconds = 0;                   // thread seconds spent on visibility
  LeafSkips skips;                      // of the whole leaf; of its enclosures' plans nothing is counted
  int delta_views = -1;                 // of the leaf's own shell; -1: nothing is seen in it, and no views were chosen
  EnclosureMask enclosure;              // where in the leaf a viewer may stand for this plan: as a rule anywhere
  /// Where walls divide the leaf, what viewers need in each of its enclosures: a part of what this plan lists. Empty else.
  std::vector<std::shared_ptr<const LeafPlan>> enclosures;

  /// Whether it lists all that can be seen from `viewpoint` (scene frame).
  bool speaks_for(const CellGrid& grid, const glm::dvec3& viewpoint) const {
    const Box box = grid.box(leaf);
    return box.contains(viewpoint) && enclosure.contains(box, viewpoint);
  }
  /// Lists the same, whenever it was made.
  bool is_same_as(const LeafPlan& other) const {
    return leaf == other.leaf && is_fallback == other.is_fallback && enclosure == other.enclosure;
  }
};

using SharedPlan = std::shared_ptr<const LeafPlan>;

/// Of a leaf's plan the part for `viewpoint`: that of its enclosure, or the whole.
inline SharedPlan plan_at(const SharedPlan& whole, const CellGrid& grid, const glm::dvec3& viewpoint) {
  for (const SharedPlan& part : whole->enclosures)
    if (part->speaks_for(grid, viewpoint)) return part;
  return whole;
}

/// Cooperative cancellation: set by whoever loses interest, polled by long work.
using CancelFlag = std::shared_ptr<const std::atomic<bool>>;
inline bool is_cancelled(const CancelFlag& flag) { return flag && flag->load(std::memory_order_relaxed); }

/// The cell octree of one scene. Thread-safe; the answers depend on scene and settings only, never on who asked
/// first. leaf_at() and plan() may cast some million rays (tens of milliseconds to a second) the first time a region is
/// asked for, on the calling thread, and remember the result.
class LeafSource {
 public:
  virtual ~LeafSource() = default;
  /// The leaf that holds a viewpoint (scene frame). Errors: kCancelled.
  virtual Result<CellId> leaf_at(const glm::dvec3& viewpoint, const CancelFlag& cancel) = 0;
  /// Whether somebody can stand in the leaf, as far as a lattice of places tells: a prediction that ends in a wall or in the
  /// ground is not worth planning for. Requires: `leaf` came from leaf_at. Some ten thousand rays, once. Errors: kCancelled.
  virtual Result<bool> can_stand_in(const CellId& leaf, const CancelFlag& cancel) {
    static_cast<void>(leaf), static_cast<void>(cancel);
    return true;
  }
  /// The plan of the whole leaf, with those of its enclosures. Requires: `leaf` came from leaf_at. Errors: kCancelled.
  virtual Result<std::shared_ptr<const LeafPlan>> plan(const CellId& leaf, const CancelFlag& cancel) = 0;
  /// The fallback view for a viewpoint: everything beyond a cell's fallback_region(), and the geometry in it. Needs no leaf:
  /// some six thousand rays.
  virtual std::shared_ptr<const LeafPlan> fallback(const glm::dvec3& viewpoint) = 0;
  virtual PlanSkips skips() const { return {}; }
};

}  // namespace farfield

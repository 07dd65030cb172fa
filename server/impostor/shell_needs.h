// SPDX-License-Identifier: Apache-2.0
// Which tiles of one shell viewers need: those that hold what some ray from them met.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "server/cells/leaf_plan.h"
#include "server/impostor/cell_space.h"
#include "server/impostor/shell_views.h"
#include "server/visibility/box_visibility.h"

namespace farfield {

/// Tiles and regions of a shell's first `views` views, seen or not.
std::uint64_t tiles_of(const ImpostorSettings& settings, std::size_t views);

/// What one shell contributes: tiles seen, with the solid angle they cover (summed over viewpoints), by the enclosure
/// of who sees them. Not thread-safe; `scene` and `settings` must outlive it.
class ShellNeeds {
 public:
  /// `sight`: who looks; its hits are added one by one.
  ShellNeeds(const Scene& scene, CellSpace space, std::shared_ptr<const ShellViews> views, const ImpostorSettings& settings,
             const BoxVisibility& sight);

  /// Requires: the hit lies in the shell.
  void add(const FarHit& hit) { waiting_.push_back({hit, 0}); }
  /// Once, when all hits are added.
  void ask_delta_views();
  int delta_views() const { return static_cast<int>(views_->positions.size()) - 1; }
  /// What the whole leaf needs none of.
  void count_skips(LeafSkips& skips) const;
  /// What the viewpoints of one enclosure need, or (kWhole) all of them together, is appended: the intra view's tiles first, then
  /// by descending share of the view.
  static constexpr int kWhole = -1;
  void list(int enclosure, std::vector<NeededTile>& tiles) const;

 private:
  struct WaitingHit : FarHit {
    double density_enough = 0;  // for views of no more slant_density() another, found before, stands in
  };
  // Solid angles, steradians summed over viewpoints.
  struct Seen {
    double first = 0;  // of what no earlier view holds: the tile's share of the view
    double again = 0;  // of what one holds coarsely: a reason to send the tile, but not before what shows something new
  };
  bool is_worth_sending(const TileId& id) const;
  void mark(int view, const FarHit& hit, bool is_held);

  const Scene& scene_;
  const CellSpace space_;
  const std::shared_ptr<const ShellViews> views_;
  const ImpostorSettings& settings_;
  double slack_;
  std::vector<WaitingHit> waiting_;
  // Of viewpoints in no enclosure first, then by enclosure.
  std::vector<std::size_t> viewpoints_;
  std::vector<std::map<TileId, Seen>> seen_;
};

}  // namespace farfield

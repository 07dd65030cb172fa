// SPDX-License-Identifier: Apache-2.0
// How a cell's shell is coded so that it costs what it may or errs no more than it must: RateTargets. Decided for the whole cell
// before its tiles are made, from a sample of them, so that a tile's bytes still depend on scene, settings, cell, view and tile only.
//
//   tiles that leaves need ─▶ some are cast ─▶ coded at the qualities a slope asks for ─▶ the slope that meets the target
//
// One slope for all tiles: each is coded at the quality where a byte takes as much off the error (colour_trial.h). Of the delta views
// so many are kept as leave the least error, that of colours coded with the bytes that are left and that of voids. Only where the
// coarsest colours without delta views cost too much, disparity is coded more coarsely, to twice its tolerance at most.
#pragma once

#include <functional>

#include "server/encode/rate_model.h"
#include "server/impostor/per_cell.h"
#include "server/impostor/view_source.h"

namespace farfield {

struct CellCoding {
  std::shared_ptr<const ShellViews> views;  // those worth their bytes
  double slope = 0;                         // levels²·sr a byte must take off
  double tolerance_scale = 1;               // of disparity
  double expected_bytes = 0;                // of the tiles that a leaf needs, and …
  double expected_mean_square = 0;          // … of their colours, 8-bit sRGB values, over directions
  bool is_over_budget = false;              // at the coarsest
};

/// Thread-safe. Bounded: forgets everything beyond 16,384 cells and decides again, with the same result.
class RateControl : public ViewSource {
 public:
  /// Casts a tile of the shell with all of the views that were searched out.
  using Caster = std::function<Result<Tile>(const TileId&, const CancelFlag&)>;
  /// `searched`: where views stand before any is found not to be worth it. Requires: settings.rate.is_set().
  RateControl(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree, std::shared_ptr<ViewSource> searched, const NestedShells& shells,
              const ImpostorSettings& settings, Caster caster);

  /// Errors: kCancelled, and the caster's. Casts some hundred tiles at most the first time and codes the colours of each at half a
  /// dozen qualities; callers that meet wait for each other.
  Result<std::shared_ptr<const CellCoding>> coding(const CellId& cell, const CancelFlag& cancel);
  Result<std::shared_ptr<const ShellViews>> views(const CellId& cell, const CancelFlag& cancel) override;
  std::uint64_t delta_views_unneeded() const override { return searched_->delta_views_unneeded() + delta_views_dropped_; }

 private:
  Result<std::shared_ptr<const CellCoding>> decide(const CellId& cell, const CancelFlag& cancel);

  const std::shared_ptr<const Scene> scene_;
  const std::shared_ptr<CellTree> tree_;
  const std::shared_ptr<ViewSource> searched_;
  const NestedShells shells_;
  const ImpostorSettings settings_;
  const Caster caster_;
  std::atomic<std::uint64_t> delta_views_dropped_{0};
  PerCell<CellCoding> decided_{16384};
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// The views of every shell asked for so far, each chosen once.
#pragma once

#include <atomic>
#include <memory>

#include "server/cells/cell_tree.h"
#include "server/impostor/per_cell.h"
#include "server/impostor/view_source.h"

namespace farfield {

/// Thread-safe. Bounded: forgets everything beyond 65,536 cells and chooses again, with the same result.
class ViewCatalogue : public ViewSource {
 public:
  ViewCatalogue(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree, const NestedShells& shells,
                const ImpostorSettings& settings)
      : scene_(std::move(scene)), tree_(std::move(tree)), shells_(shells), settings_(settings), root_(tree_->scene_root()) {}

  Result<std::shared_ptr<const ShellViews>> views(const CellId& cell, const CancelFlag& cancel) override;
  std::uint64_t delta_views_unneeded() const override { return delta_views_unneeded_; }

 private:
  const std::shared_ptr<const Scene> scene_;
  const std::shared_ptr<CellTree> tree_;
  const NestedShells shells_;
  const ImpostorSettings settings_;
  const CellId root_;
  std::atomic<std::uint64_t> delta_views_unneeded_{0};
  PerCell<ShellViews> chosen_{65536};
};

}  // namespace farfield

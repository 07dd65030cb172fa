// SPDX-License-Identifier: Apache-2.0
// The views of every shell asked for so far, each chosen once.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "server/cells/cell_tree.h"
#include "server/cells/leaf_plan.h"
#include "server/impostor/shell_views.h"

namespace farfield {

/// Thread-safe. Bounded: forgets everything beyond 65,536 cells and chooses again, with the same result.
class ViewCatalogue {
 public:
  ViewCatalogue(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree, const NestedShells& shells,
                const ImpostorSettings& settings)
      : scene_(std::move(scene)), tree_(std::move(tree)), shells_(shells), settings_(settings), root_(tree_->scene_root()) {}

  /// Errors: kCancelled. Casts some hundred thousand rays the first time; callers that meet wait for each other.
  Result<std::shared_ptr<const ShellViews>> views(const CellId& cell, const CancelFlag& cancel);
  /// Delta views that were allowed and not chosen, over all shells so far: they would have added less than the target.
  std::uint64_t delta_views_unneeded() const { return delta_views_unneeded_; }

 private:
  struct Entry {
    std::mutex mutex;
    std::shared_ptr<const ShellViews> views;
  };
  const std::shared_ptr<const Scene> scene_;
  const std::shared_ptr<CellTree> tree_;
  const NestedShells shells_;
  const ImpostorSettings settings_;
  const CellId root_;
  std::atomic<std::uint64_t> delta_views_unneeded_{0};
  std::mutex mutex_;  // guards entries_, not what they point to
  std::unordered_map<CellId, std::shared_ptr<Entry>> entries_;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// From a leaf cell to what a viewer in it needs: visibility before casting. Only tiles that some ray from the leaf
// reaches are ever made: in a closed room the outer shells cost nothing.
#pragma once

#include <mutex>

#include "server/cells/cell_tree.h"
#include "server/impostor/view_source.h"

namespace farfield {

class LeafPlanner : public LeafSource {
 public:
  LeafPlanner(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree, std::shared_ptr<ViewSource> views,
              const NestedShells& shells, const ImpostorSettings& settings);

  Result<CellId> leaf_at(const glm::dvec3& viewpoint, const CancelFlag& cancel) override;
  Result<bool> can_stand_in(const CellId& leaf, const CancelFlag& cancel) override;
  Result<std::shared_ptr<const LeafPlan>> plan(const CellId& leaf, const CancelFlag& cancel) override;
  std::shared_ptr<const LeafPlan> fallback(const glm::dvec3& viewpoint) override;
  PlanSkips skips() const override;

 private:
  /// Nearest to the cell's centre first.
  void sort_chunks(LeafPlan& plan) const;
  void list_near(LeafPlan& plan, const Sight& sight) const;
  /// Counts what the whole leaf's plan leaves out of its near region.
  void count_unseen_chunks(LeafPlan& plan) const;

  const std::shared_ptr<const Scene> scene_;
  const std::shared_ptr<CellTree> tree_;
  const std::shared_ptr<ViewSource> views_;
  const NestedShells shells_;
  const ImpostorSettings settings_;
  mutable std::mutex mutex_;  // guards skipped_
  LeafSkips skipped_;         // of all plans
};

}  // namespace farfield

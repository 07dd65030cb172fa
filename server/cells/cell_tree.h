// SPDX-License-Identifier: Apache-2.0
// The cell octree of one scene: lazily and deterministically subdivided until the near geometry of a cell fits the
// budget (Aliaga 1998, chapter 3: a bound on geometry for every viewpoint; here leaves lie at different levels).
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "common/cells/nested_shells.h"
#include "server/cells/leaf_plan.h"
#include "server/visibility/box_visibility.h"

namespace farfield {

class CellTree {
 public:
  CellTree(std::shared_ptr<const Scene> scene, const NestedShells& shells, std::uint32_t near_triangles);

  /// The smallest ancestor-closed cell that holds the scene; grown by doubling until it holds `viewpoint` as well.
  /// Roots end at kMaxCellLevel, which is to say some 9e7 finest sides from the origin. Viewpoints beyond are taken for
  /// the nearest place within (on_grid()), so every root and every leaf is that of a place the tree can name.
  CellId root_for(const glm::dvec3& viewpoint) const;
  CellId scene_root() const { return scene_root_; }

  /// `viewpoint`, or the nearest place of the largest root if it lies beyond; 0 for a coordinate that is no number.
  glm::dvec3 on_grid(const glm::dvec3& viewpoint) const;

  /// The leaf that holds on_grid(viewpoint). Casts rays only where no earlier call has decided. Errors: kCancelled.
  Result<CellId> leaf_at(const glm::dvec3& viewpoint, const CancelFlag& cancel);

  /// The cell whose fallback view is made for a viewpoint before its leaf is known: the largest whose fallback_region()
  /// holds at most half of the budget's triangles, hidden or not, else the finest. Like a leaf it is small where the model
  /// is dense, but asks for no ray. O(levels · chunks in the region).
  CellId fallback_cell(const glm::dvec3& viewpoint) const;

  /// Whether a cell is a leaf of the tree. Requires: it holds a leaf or is one. Errors: kCancelled.
  Result<bool> is_leaf(const CellId& cell, const CancelFlag& cancel);

  /// Whether a leaf holds a free place (find_standpoints). Remembered. Requires: a leaf. Errors: kCancelled.
  Result<bool> can_stand_in(const CellId& leaf, const CancelFlag& cancel);

  /// What can be seen from a leaf, at full density. Remembers the last few. Errors: kCancelled.
  Result<std::shared_ptr<const BoxVisibility>> visibility(const CellId& cell, const CancelFlag& cancel);

 private:
  enum class Kind { kLeaf, kInner };
  std::size_t triangles_of(const std::vector<std::uint32_t>& chunks) const;
  /// What a cell is, and the lock of whoever finds out.
  struct Verdict {
    std::mutex mutex;
    std::optional<Kind> kind;
    std::optional<bool> can_stand;
  };
  std::shared_ptr<Verdict> verdict_on(const CellId& cell);
  /// Remembers the answer, whoever asked; callers that meet wait for each other. Errors: kCancelled, before it began.
  Result<Kind> classify(const CellId& cell, const CancelFlag& cancel);
  Kind decide(const CellId& cell);
  void remember(const CellId& cell, std::shared_ptr<const BoxVisibility> visibility);

  const std::shared_ptr<const Scene> scene_;
  const NestedShells shells_;
  const std::uint32_t near_triangles_;
  const double voxel_m_;  // how closely enclosures follow walls: a person's eyes are not nearer to one, as a rule
  CellId scene_root_;

  std::mutex mutex_;  // guards everything below; never held while rays are cast
  std::unordered_map<CellId, std::shared_ptr<Verdict>> verdicts_;
  std::list<std::pair<CellId, std::shared_ptr<const BoxVisibility>>> recent_;  // newest first
};

}  // namespace farfield

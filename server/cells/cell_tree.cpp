// SPDX-License-Identifier: Apache-2.0
#include "server/cells/cell_tree.h"

#include <algorithm>
#include <cmath>

#include "server/visibility/standpoints.h"

namespace farfield {
namespace {

constexpr std::size_t kRememberedVisibilities = 16;

// What stands around the cell is drawn and sent whole, hidden or not, and before anything else: a part of the budget.
constexpr std::uint32_t kFallbackShare = 2;

const std::atomic<bool>* pointer(const CancelFlag& flag) { return flag.get(); }

}  // namespace

CellTree::CellTree(std::shared_ptr<const Scene> scene, const NestedShells& shells, std::uint32_t near_triangles)
    : scene_(std::move(scene)), shells_(shells), near_triangles_(near_triangles), voxel_m_(shells.grid.finest_side_m / 2) {
  scene_root_ = shells_.grid.enclosing(scene_->bounds());
}

glm::dvec3 CellTree::on_grid(const glm::dvec3& viewpoint) const {
  const Box grid = shells_.grid.box(scene_root_.ancestor(kMaxCellLevel));
  glm::dvec3 held;
  for (int axis = 0; axis < 3; ++axis) {
    const double last = std::nextafter(grid.max[axis], grid.min[axis]);  // cells are half open
    held[axis] = std::isnan(viewpoint[axis]) ? 0.0 : std::clamp(viewpoint[axis], grid.min[axis], last);
  }
  return held;
}

CellId CellTree::root_for(const glm::dvec3& viewpoint) const {
  const glm::dvec3 held = on_grid(viewpoint);
  CellId root = scene_root_;
  while (root.level < kMaxCellLevel && !shells_.grid.box(root).contains(held)) root = root.parent();
  return root;
}

Result<CellId> CellTree::leaf_at(const glm::dvec3& viewpoint, const CancelFlag& cancel) {
  const glm::dvec3 held = on_grid(viewpoint);
  const CellId root = root_for(held);
  for (int level = root.level;; --level) {
    const CellId cell = shells_.grid.cell_at(held, level);
    const Result<Kind> kind = classify(cell, cancel);
    if (!kind) return tl::unexpected(kind.error());
    if (*kind == Kind::kLeaf) return cell;
  }
}

Result<bool> CellTree::is_leaf(const CellId& cell, const CancelFlag& cancel) {
  const Result<Kind> kind = classify(cell, cancel);
  if (!kind) return tl::unexpected(kind.error());
  return *kind == Kind::kLeaf;
}

std::size_t CellTree::triangles_of(const std::vector<std::uint32_t>& chunks) const {
  std::size_t sum = 0;
  for (const std::uint32_t chunk : chunks) sum += scene_->chunks()[chunk].triangles;
  return sum;
}

std::shared_ptr<CellTree::Verdict> CellTree::verdict_on(const CellId& cell) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Verdict>& slot = verdicts_[cell];
  if (!slot) slot = std::make_shared<Verdict>();
  return slot;
}

Result<bool> CellTree::can_stand_in(const CellId& leaf, const CancelFlag& cancel) {
  if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
  const std::shared_ptr<Verdict> verdict = verdict_on(leaf);
  const std::lock_guard lock(verdict->mutex);
  if (!verdict->can_stand) verdict->can_stand = !find_standpoints(*scene_, shells_.grid.box(leaf)).all_blocked;
  return *verdict->can_stand;
}

Result<CellTree::Kind> CellTree::classify(const CellId& cell, const CancelFlag& cancel) {
  if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
  const std::shared_ptr<Verdict> verdict = verdict_on(cell);
  // Every viewer nearby needs this answer: it is found once, and a search that has begun is not thrown away.
  const std::lock_guard lock(verdict->mutex);
  if (!verdict->kind) verdict->kind = decide(cell);
  return *verdict->kind;
}

CellTree::Kind CellTree::decide(const CellId& cell) {
  if (cell.level == 0) return Kind::kLeaf;
  const Box box = shells_.grid.box(cell), near_box = shells_.near_region(cell);
  if (triangles_of(scene_->chunks_in(near_box)) <= near_triangles_) return Kind::kLeaf;
  // A coarse probe finds most of what is visible: enough to reject a cell that is far above the budget.
  if (probe_visibility(*scene_, box, near_box, {.edge = 32, .enough_triangles = near_triangles_, .is_thorough = false}).is_cut_short)
    return Kind::kInner;
  auto fine = std::make_shared<BoxVisibility>(probe_visibility(
      *scene_, box, near_box, {.enough_triangles = near_triangles_, .enclosure_voxel_m = voxel_m_}));
  // A cell that samples of its viewpoints cannot speak for is divided until they can.
  if (fine->is_cut_short || !fine->is_converged) return Kind::kInner;
  remember(cell, std::move(fine));
  return Kind::kLeaf;
}

void CellTree::remember(const CellId& cell, std::shared_ptr<const BoxVisibility> visibility) {
  const std::lock_guard lock(mutex_);
  recent_.emplace_front(cell, std::move(visibility));
  if (recent_.size() > kRememberedVisibilities) recent_.pop_back();
}

CellId CellTree::fallback_cell(const glm::dvec3& viewpoint) const {
  const glm::dvec3 held = on_grid(viewpoint);
  const CellId root = root_for(held);
  CellId cell = shells_.grid.cell_at(held, 0);
  while (cell.level < root.level) {
    const CellId next = cell.parent();
    if (triangles_of(scene_->chunks_in(shells_.fallback_region(next))) > near_triangles_ / kFallbackShare) break;
    cell = next;
  }
  return cell;
}

Result<std::shared_ptr<const BoxVisibility>> CellTree::visibility(const CellId& cell, const CancelFlag& cancel) {
  {
    const std::lock_guard lock(mutex_);
    for (auto i = recent_.begin(); i != recent_.end(); ++i)
      if (i->first == cell) {
        recent_.splice(recent_.begin(), recent_, i);
        return recent_.front().second;
      }
  }
  const Box near_box = shells_.near_region(cell);
  auto made = std::make_shared<BoxVisibility>(probe_visibility(
      *scene_, shells_.grid.box(cell), near_box, {.enclosure_voxel_m = voxel_m_, .cancel = pointer(cancel)}));
  if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
  remember(cell, made);
  return made;
}

}  // namespace farfield

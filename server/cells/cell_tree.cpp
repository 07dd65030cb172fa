// SPDX-License-Identifier: Apache-2.0
#include "server/cells/cell_tree.h"

#include <algorithm>
#include <cmath>

namespace farfield {
namespace {

constexpr std::size_t kRememberedVisibilities = 16;

const std::atomic<bool>* pointer(const CancelFlag& flag) { return flag.get(); }

}  // namespace

CellTree::CellTree(std::shared_ptr<const Scene> scene, const NestedShells& shells, std::uint32_t near_triangles)
    : scene_(std::move(scene)), shells_(shells), near_triangles_(near_triangles) {
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

Result<CellTree::Kind> CellTree::classify(const CellId& cell, const CancelFlag& cancel) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = kinds_.find(cell); found != kinds_.end()) return found->second;
  }
  const auto decide = [&]() -> Result<Kind> {
    if (cell.level == 0) return Kind::kLeaf;
    const Box near_box = shells_.near_region(cell);
    if (triangles_of(scene_->chunks_in(near_box)) <= near_triangles_) return Kind::kLeaf;
    // A coarse probe finds most of what is visible: enough to reject a cell that is far above the budget.
    VisibilityProbe coarse{.edge = 32, .enough_triangles = near_triangles_, .is_thorough = false, .cancel = pointer(cancel)};
    if (probe_visibility(*scene_, shells_.grid.box(cell), near_box, coarse).is_cut_short)
      return is_cancelled(cancel) ? Result<Kind>(fail(ErrorCode::kCancelled, "cancelled")) : Result<Kind>(Kind::kInner);
    const auto fine = visibility(cell, cancel);
    if (!fine) return tl::unexpected(fine.error());
    // A cell that samples of its viewpoints cannot speak for is divided until they can.
    return (*fine)->near_triangles <= near_triangles_ && (*fine)->is_converged ? Kind::kLeaf : Kind::kInner;
  };
  const Result<Kind> kind = decide();
  if (kind) {
    const std::lock_guard lock(mutex_);
    kinds_.emplace(cell, *kind);
  }
  return kind;
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
  auto made = std::make_shared<BoxVisibility>(probe_visibility(*scene_, shells_.grid.box(cell), near_box, {.cancel = pointer(cancel)}));
  // Where everything near fits the budget nothing needs to be left out.
  const std::vector<std::uint32_t> all = scene_->chunks_in(near_box);
  if (const std::size_t triangles = triangles_of(all); triangles <= near_triangles_) {
    made->near_chunks = all;
    made->near_triangles = triangles;
  }
  if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
  const std::lock_guard lock(mutex_);
  recent_.emplace_front(cell, made);
  if (recent_.size() > kRememberedVisibilities) recent_.pop_back();
  return made;
}

}  // namespace farfield

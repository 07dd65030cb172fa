// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/view_catalogue.h"

namespace farfield {

Result<std::shared_ptr<const ShellViews>> ViewCatalogue::views(const CellId& cell, const CancelFlag& cancel) {
  constexpr std::size_t kMostEntries = 65536;
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    if (entries_.size() >= kMostEntries) entries_.clear();
    std::shared_ptr<Entry>& slot = entries_[cell];
    if (!slot) slot = std::make_shared<Entry>();
    entry = slot;
  }
  const std::lock_guard lock(entry->mutex);
  if (entry->views) return entry->views;
  const Result<bool> is_leaf = tree_->is_leaf(cell, cancel);
  if (!is_leaf) return tl::unexpected(is_leaf.error());
  const ViewSearchWidth width = *is_leaf ? ViewSearchWidth::kLeaf : ViewSearchWidth::kInnerCell;
  auto made = std::make_shared<ShellViews>(
      choose_views(*scene_, CellSpace::of_shell(shells_, cell, root_), settings_, width, cancel.get()));
  if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
  delta_views_unneeded_ += static_cast<std::uint64_t>(made->delta_views_allowed) + 1 - made->positions.size();
  entry->views = made;
  return entry->views;
}

}  // namespace farfield

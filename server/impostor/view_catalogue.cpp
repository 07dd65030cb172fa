// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/view_catalogue.h"

namespace farfield {

Result<std::shared_ptr<const ShellViews>> ViewCatalogue::views(const CellId& cell, const CancelFlag& cancel) {
  return chosen_.get(cell, [&]() -> Result<std::shared_ptr<const ShellViews>> {
    const Result<bool> is_leaf = tree_->is_leaf(cell, cancel);
    if (!is_leaf) return tl::unexpected(is_leaf.error());
    const ViewSearchWidth width = *is_leaf ? ViewSearchWidth::kLeaf : ViewSearchWidth::kInnerCell;
    auto made = std::make_shared<ShellViews>(
        choose_views(*scene_, CellSpace::of_shell(shells_, cell, root_), settings_, width, cancel.get()));
    if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
    delta_views_unneeded_ += static_cast<std::uint64_t>(made->delta_views_allowed) + 1 - made->positions.size();
    return made;
  });
}

}  // namespace farfield

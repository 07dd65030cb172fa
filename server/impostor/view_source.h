// SPDX-License-Identifier: Apache-2.0
// Where the views of a shell stand, whoever decided it.
#pragma once

#include "server/cells/leaf_plan.h"
#include "server/impostor/shell_views.h"

namespace farfield {

/// Thread-safe. The answers depend on scene, settings and cell only.
class ViewSource {
 public:
  virtual ~ViewSource() = default;
  /// Errors: kCancelled. Casts some hundred thousand rays the first time; callers that meet wait for each other.
  virtual Result<std::shared_ptr<const ShellViews>> views(const CellId& cell, const CancelFlag& cancel) = 0;
  /// Delta views that were allowed and not chosen, over all shells so far: they would have added less than they cost.
  virtual std::uint64_t delta_views_unneeded() const = 0;
};

}  // namespace farfield

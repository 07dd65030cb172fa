// SPDX-License-Identifier: Apache-2.0
#include "client/warp/shown_depths.h"

namespace farfield::client {

bool ShownDepths::hides(const PixelRectangle& pixels, std::uint32_t bound, int column, int row) {
  const int left = column * kEdge, top = window_.top + row * kEdge;
  const PixelRectangle whole{left, std::min(left + kEdge, window_.width) - 1, top, std::min(top + kEdge, window_.bottom) - 1};
  const PixelRectangle part{std::max(whole.left, pixels.left), std::min(whole.right, pixels.right),
                            std::max(whole.top, pixels.top), std::min(whole.bottom, pixels.bottom)};
  // Most often one of the first pixels says no: the cell is only worth looking through where something hides.
  if (any_smaller_in(part, make_key(bound, ~0u), window_.width, keys_)) return false;
  std::uint32_t& cell = cells_[index(column, row)];
  if ((cell & kIsCurrent) == 0) cell = static_cast<std::uint32_t>(smallest_key(whole, window_.width, keys_) >> 32) | kIsCurrent;
  return true;
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/surface_patch.h"

namespace farfield {

void classify_quads(const SurfacePatch& patch, std::vector<QuadKind>& kinds) {
  const int columns = patch.width - 1, rows = patch.height - 1;
  if (columns <= 0 || rows <= 0) {
    kinds.clear();
    return;
  }
  kinds.resize(static_cast<std::size_t>(columns) * rows);
  for (int y = 0; y < rows; ++y) {
    const std::size_t up = patch.at(0, y), down = patch.at(0, y + 1);
    const std::uint8_t *upper = patch.coverage + up, *lower = patch.coverage + down;
    const std::uint8_t *right_above = patch.cut_right + up, *right_below = patch.cut_right + down;
    const std::uint8_t* cut_down = patch.cut_down + up;
    QuadKind* row = kinds.data() + static_cast<std::size_t>(y) * columns;
    for (int x = 0; x < columns; ++x) {
      const int covered = (upper[x] != 0) + (upper[x + 1] != 0) + (lower[x] != 0) + (lower[x + 1] != 0);
      const int cuts = right_above[x] | right_below[x] | cut_down[x] | cut_down[x + 1];
      const int kind = (covered != 0 ? 1 : 0) + (covered == 4 && cuts == 0 ? 1 : 0);
      row[x] = static_cast<QuadKind>(kind);
    }
  }
}

namespace {

/// Between (x, y) and the sample `sign` steps along `axis`.
bool joins(const SurfacePatch& patch, int x, int y, int axis, int sign) {
  const int dx = axis == 0 ? sign : 0, dy = axis == 1 ? sign : 0;
  return sign > 0 ? patch.is_connected(x, y, axis) : patch.is_connected(x + dx, y + dy, axis);
}

}  // namespace

float outward_slope(const SurfacePatch& patch, int x, int y, int axis, int sign) {
  const int dx = axis == 0 ? sign : 0, dy = axis == 1 ? sign : 0;
  const auto disparity = [&](int i, int j) { return patch.disparity[patch.at(i, j)]; };
  if (joins(patch, x, y, axis, -sign)) return disparity(x, y) - disparity(x - dx, y - dy);

  float sum = 0;
  int found = 0;
  for (const int side : {-1, 1}) {
    if (!joins(patch, x, y, 1 - axis, side)) continue;
    const int i = x + (axis == 1 ? side : 0), j = y + (axis == 0 ? side : 0);
    if (joins(patch, i, j, axis, sign)) {
      sum += disparity(i + dx, j + dy) - disparity(i, j);
      ++found;
    } else if (joins(patch, i, j, axis, -sign)) {
      sum += disparity(i, j) - disparity(i - dx, j - dy);
      ++found;
    }
  }
  return found > 0 ? sum / static_cast<float>(found) : 0.0f;
}

}  // namespace farfield

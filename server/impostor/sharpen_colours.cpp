// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/sharpen_colours.h"

#include <algorithm>

namespace farfield {
namespace {

// Per channel of a row's samples: 1 where the surface goes on to both sides, across or down.
struct Smooth {
  std::vector<std::int16_t> across, down;
};

void find_smooth(const Tile& tile, int y, Smooth& smooth) {
  const int width = tile.width, edge = tile.is_packed() ? kBlockSamples : width, rows = tile.is_packed() ? kBlockSamples : tile.height;
  const std::size_t row = static_cast<std::size_t>(y) * width;
  const std::uint8_t *covered = &tile.coverage[row], *cut_right = &tile.cut_right[row], *cut_down = &tile.cut_down[row];
  const bool has_rows = y % rows != 0 && (y + 1) % rows != 0;
  for (int x = 0; x < width; ++x) {
    // In packed tiles, what stands beyond a block's edge lies elsewhere on the face.
    const bool has_columns = x % edge != 0 && (x + 1) % edge != 0;
    const bool across = has_columns && covered[x] && covered[x - 1] && covered[x + 1] && cut_right[x - 1] == kConnected && cut_right[x] == kConnected;
    const bool down = has_rows && covered[x] && covered[x - width] && covered[x + width] && cut_down[x - width] == kConnected && cut_down[x] == kConnected;
    for (int c = 3 * x; c < 3 * x + 3; ++c) smooth.across[c] = across, smooth.down[c] = down;
  }
}

}  // namespace

void sharpen_colours(const Tile& tile, std::vector<std::uint8_t>& rgb) {
  const int count = 3 * tile.width;
  Smooth smooth{std::vector<std::int16_t>(count), std::vector<std::int16_t>(count)};
  // Rows as they were, of which each is read after the one above it has changed.
  std::vector<std::uint8_t> above(count), own(count);
  for (int y = 0; y < tile.height; ++y) {
    std::uint8_t* out = &rgb[static_cast<std::size_t>(y) * count];
    above.swap(own);
    std::copy_n(out, count, own.begin());
    find_smooth(tile, y, smooth);
    const std::uint8_t* below = y + 1 < tile.height ? out + count : own.data();
    for (int k = 0; k < count; ++k) {
      const int left = own[std::max(k - 3, 0)], right = own[std::min(k + 3, count - 1)];
      const int excess = smooth.across[k] * (2 * own[k] - left - right) + smooth.down[k] * (2 * own[k] - above[k] - below[k]);
      out[k] = static_cast<std::uint8_t>(std::clamp(own[k] + ((kSharpening * excess + 32) >> 6), 0, 255));
    }
  }
}

}  // namespace farfield

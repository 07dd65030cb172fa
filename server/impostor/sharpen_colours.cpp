// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/sharpen_colours.h"

#include <algorithm>
#include <array>

namespace farfield {
namespace {

// Per channel of a row's samples: 1 where the surface goes on to both sides, across or down.
struct Smooth {
  std::vector<std::uint8_t> across, down;
};

void find_smooth(const Tile& tile, int y, std::vector<std::uint8_t>& flags, Smooth& smooth) {
  const int width = tile.width, edge = tile.is_packed() ? kBlockSamples : width, rows = tile.is_packed() ? kBlockSamples : tile.height;
  const std::size_t row = static_cast<std::size_t>(y) * width;
  const std::uint8_t *covered = &tile.coverage[row], *cut_right = &tile.cut_right[row], *cut_down = &tile.cut_down[row];
  std::fill(flags.begin(), flags.end(), 0);
  std::uint8_t *across = flags.data(), *down = across + width;
  for (int x = 1; x + 1 < width; ++x)
    across[x] = static_cast<std::uint8_t>(covered[x - 1] & covered[x] & covered[x + 1] & (cut_right[x - 1] == kConnected) & (cut_right[x] == kConnected));
  // In packed tiles, what stands beyond a block's edge lies elsewhere on the face.
  for (int x = edge; x < width; x += edge) across[x - 1] = across[x] = 0;
  if (y % rows != 0 && (y + 1) % rows != 0)
    for (int x = 0; x < width; ++x)
      down[x] = static_cast<std::uint8_t>(covered[x - width] & covered[x] & covered[x + width] & (cut_down[x - width] == kConnected) & (cut_down[x] == kConnected));
  for (int x = 0; x < width; ++x)
    for (int c = 0; c < 3; ++c) smooth.across[3 * x + c] = across[x], smooth.down[3 * x + c] = down[x];
}

// Of a row's channels: themselves, those of the rows above and below, and where they may be compared.
struct Neighbours {
  const std::uint8_t *own, *above, *below, *across, *down;
};

constexpr std::size_t kAtOnce = 32;

// Results go by way of registers: what is read might overlap with what is written.
template <std::size_t kCount>
void sharpen(const Neighbours& beside, std::size_t first, std::uint8_t* out) {
  const std::uint8_t *own = beside.own + first, *above = beside.above + first, *below = beside.below + first;
  const std::uint8_t *across = beside.across + first, *down = beside.down + first;
  std::array<std::uint8_t, kCount> sharpened;
  for (std::size_t k = 0; k < kCount; ++k) {
    const auto over = static_cast<std::int16_t>(2 * own[k] - own[static_cast<std::ptrdiff_t>(k) - 3] - own[k + 3]), under = static_cast<std::int16_t>(2 * own[k] - above[k] - below[k]);
    const auto excess = static_cast<std::int16_t>(across[k] * over + down[k] * under);
    const auto level = static_cast<std::int16_t>(own[k] + (static_cast<std::int16_t>(kSharpening * excess + 32) >> 6));
    sharpened[k] = static_cast<std::uint8_t>(level < 0 ? 0 : level > 255 ? 255 : level);
  }
  std::copy_n(sharpened.begin(), kCount, out + first);
}

}  // namespace

void sharpen_colours(const Tile& tile, std::vector<std::uint8_t>& rgb) {
  const std::size_t count = 3 * static_cast<std::size_t>(tile.width);
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(2 * tile.width));
  Smooth smooth{std::vector<std::uint8_t>(count), std::vector<std::uint8_t>(count)};
  // Rows as they were, of which each is read after the one above it has changed; a sample more at either end.
  std::vector<std::uint8_t> before(count + 6), row(count + 6);
  for (int y = 0; y < tile.height; ++y) {
    std::uint8_t* out = &rgb[y * count];
    before.swap(row);
    std::copy_n(out, count, row.begin() + 3);
    find_smooth(tile, y, flags, smooth);
    const Neighbours beside{&row[3], &before[3], y + 1 < tile.height ? out + count : &row[3], smooth.across.data(), smooth.down.data()};
    std::size_t first = 0;
    for (; first + kAtOnce <= count; first += kAtOnce) sharpen<kAtOnce>(beside, first, out);
    for (; first < count; ++first) sharpen<1>(beside, first, out);
  }
}

}  // namespace farfield

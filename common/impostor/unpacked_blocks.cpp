// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/unpacked_blocks.h"

#include <algorithm>

namespace farfield {
namespace {

struct BlockBounds {
  int min_x = 0xffff, min_y = 0xffff, max_x = 0, max_y = 0;
};

BlockBounds bounds_of(const Tile& tile) {
  BlockBounds bounds;
  for (const BlockPlace& b : tile.blocks) {
    bounds.min_x = std::min<int>(bounds.min_x, b.x), bounds.max_x = std::max<int>(bounds.max_x, b.x);
    bounds.min_y = std::min<int>(bounds.min_y, b.y), bounds.max_y = std::max<int>(bounds.max_y, b.y);
  }
  return bounds;
}

std::size_t packed_index(const Tile& tile, std::size_t block, int x, int y) {
  const std::size_t column = block % kPackedColumns * kBlockSamples + static_cast<std::size_t>(x);
  const std::size_t row = block / kPackedColumns * kBlockSamples + static_cast<std::size_t>(y);
  return row * static_cast<std::size_t>(tile.width) + column;
}

/// A block's texels, and a ring of one texel around it wherever no block has written: filtering reaches that far.
void copy_texels(const Tile& tile, const std::vector<std::uint8_t>& rgb, std::size_t block, int left, int top, std::vector<std::uint8_t>& written,
                 UnpackedBlocks& out) {
  const int width = out.width - 2, height = out.height - 2;
  for (int y = -1; y <= kBlockSamples; ++y) {
    for (int x = -1; x <= kBlockSamples; ++x) {
      if (left + x < 0 || top + y < 0 || left + x >= width || top + y >= height) continue;
      const std::size_t to = static_cast<std::size_t>(top + y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(left + x);
      const bool is_own = x >= 0 && y >= 0 && x < kBlockSamples && y < kBlockSamples;
      if (!is_own && written[to]) continue;
      written[to] |= is_own;
      const std::size_t from =
          3 * packed_index(tile, block, std::clamp(x, 0, kBlockSamples - 1), std::clamp(y, 0, kBlockSamples - 1));
      std::copy_n(rgb.begin() + static_cast<std::ptrdiff_t>(from), 3, out.rgb.begin() + static_cast<std::ptrdiff_t>(3 * to));
    }
  }
}

}  // namespace

bool is_one_region(const Tile& tile) {
  if (tile.blocks.empty()) return true;
  const BlockBounds b = bounds_of(tile);
  return b.max_x - b.min_x < kRegionBlocks && b.max_y - b.min_y < kRegionBlocks;
}

UnpackedBlocks unpack_blocks(const Tile& tile, const std::vector<std::uint8_t>& rgb) {
  const BlockBounds bounds = bounds_of(tile);
  UnpackedBlocks out;
  out.face_x = bounds.min_x * kBlockSamples - 1, out.face_y = bounds.min_y * kBlockSamples - 1;
  out.width = (bounds.max_x - bounds.min_x + 1) * kBlockSamples + 2;
  out.height = (bounds.max_y - bounds.min_y + 1) * kBlockSamples + 2;
  const std::size_t samples = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
  const std::size_t texels = static_cast<std::size_t>(out.width - 2) * static_cast<std::size_t>(out.height - 2);
  out.coverage.assign(samples, 0), out.cut_right.assign(samples, 0), out.cut_down.assign(samples, 0);
  out.disparity.assign(samples, 0);
  out.rgb.assign(3 * texels, 0);
  std::vector<std::uint8_t> written(texels, 0);
  for (std::size_t block = 0; block < tile.blocks.size(); ++block) {
    const int left = (tile.blocks[block].x - bounds.min_x) * kBlockSamples;
    const int top = (tile.blocks[block].y - bounds.min_y) * kBlockSamples;
    for (int y = 0; y < kBlockSamples; ++y) {
      for (int x = 0; x < kBlockSamples; ++x) {
        const std::size_t from = packed_index(tile, block, x, y);
        const std::size_t to = static_cast<std::size_t>(top + y + 1) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(left + x + 1);
        out.coverage[to] = tile.coverage[from], out.disparity[to] = tile.disparity[from];
        out.cut_right[to] = tile.cut_right[from], out.cut_down[to] = tile.cut_down[from];
      }
    }
    copy_texels(tile, rgb, block, left, top, written, out);
  }
  return out;
}

}  // namespace farfield

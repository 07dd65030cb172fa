// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/block_window.h"

#include <algorithm>

namespace farfield {
namespace {

std::uint32_t place_key(int x, int y) { return static_cast<std::uint32_t>(y) << 16 | static_cast<std::uint32_t>(x); }

}  // namespace

BlockMap::BlockMap(const Tile& tile) {
  index_of_.reserve(tile.blocks.size());
  for (std::size_t b = 0; b < tile.blocks.size(); ++b) {
    index_of_.emplace(place_key(tile.blocks[b].x, tile.blocks[b].y), static_cast<int>(b));
  }
}

int BlockMap::find(int x, int y) const {
  if (x < 0 || y < 0 || x > 0xffff || y > 0xffff) return -1;
  const auto found = index_of_.find(place_key(x, y));
  return found == index_of_.end() ? -1 : found->second;
}

void BlockWindow::load(const Tile& tile, const BlockMap& map, std::size_t block) {
  const BlockPlace place = tile.blocks[block];
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) neighbours_[(dy + 1) * 3 + dx + 1] = map.find(place.x + dx, place.y + dy);
  }
  const auto part = [](int k) { return k == 0 ? 0 : (k <= kBlockSamples ? 1 : 2); };  // before, own, after
  for (int y = 0; y < kWindowSamples; ++y) {
    for (int x = 0; x < kWindowSamples; ++x) {
      const int at = y * kWindowSamples + x;
      const int from = neighbours_[part(y) * 3 + part(x)];
      if (from < 0) {
        source_[at] = -1;
        coverage_[at] = cut_right_[at] = cut_down_[at] = 0;
        disparity_[at] = 0;
        continue;
      }
      const int column = from % kPackedColumns * kBlockSamples + ((x + kBlockSamples - 1) % kBlockSamples);
      const std::int64_t row = from / kPackedColumns * kBlockSamples + ((y + kBlockSamples - 1) % kBlockSamples);
      const std::int64_t source = row * tile.width + column;
      source_[at] = source;
      coverage_[at] = tile.coverage[source];
      cut_right_[at] = tile.cut_right[source];
      cut_down_[at] = tile.cut_down[source];
      disparity_[at] = tile.disparity[source];
    }
  }
}

SurfacePatch BlockWindow::patch() const {
  return {kWindowSamples,    kWindowSamples,    coverage_.data(), disparity_.data(),
          cut_right_.data(), cut_down_.data()};
}

void BlockWindow::leave_to_neighbours(std::vector<QuadKind>& kinds) const {
  const int columns = kWindowSamples - 1;
  const bool has_left = has_block(-1, 0), has_above = has_block(0, -1);
  for (int k = 1; k < columns; ++k) {
    if (has_left) kinds[k * columns] = QuadKind::kNone;
    if (has_above) kinds[k] = QuadKind::kNone;
  }
  // The quad at the upper right corner belongs to the upper right block before this one.
  if (has_block(1, -1)) kinds[columns - 1] = QuadKind::kNone;
  if (has_block(-1, -1) || has_above || has_left) kinds[0] = QuadKind::kNone;
}

void BlockWindow::store_used(const std::vector<std::uint8_t>& window, std::vector<std::uint8_t>& tile) const {
  for (int k = 0; k < kCount; ++k) {
    if (source_[k] >= 0 && window[k]) tile[source_[k]] = 1;
  }
}

void BlockWindow::load_used(const std::vector<std::uint8_t>& tile, std::vector<std::uint8_t>& window) const {
  window.resize(kCount);
  for (int k = 0; k < kCount; ++k) window[k] = source_[k] >= 0 ? tile[source_[k]] : 0;
}

void BlockWindow::copy_texels(const Tile& tile, std::uint8_t* rgb, int row_texels) const {
  for (int y = 0; y < kWindowSamples; ++y) {
    for (int x = 0; x < kWindowSamples; ++x) {
      std::int64_t source = source_[y * kWindowSamples + x];
      if (source < 0) {
        const int i = std::clamp(x, 1, kBlockSamples), j = std::clamp(y, 1, kBlockSamples);
        source = source_[j * kWindowSamples + i];
      }
      std::copy_n(tile.rgb.data() + 3 * source, 3, rgb + 3 * (static_cast<std::size_t>(y) * row_texels + x));
    }
  }
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/visible_blocks.h"

#include <algorithm>

namespace farfield {
namespace {

// The probe's viewpoints are half a side apart: what shows only between two of them borders on what they saw.
constexpr int kGrowth = 2;

}  // namespace

VisibleBlocks::VisibleBlocks(const BoxVisibility& seen, const CellSpace& space, const glm::dvec3& view, int edge_samples)
    : edge_((edge_samples + kBlockSamples - 1) / kBlockSamples) {
  std::vector<bool> hit(static_cast<std::size_t>(kCubeFaces) * edge_ * edge_, false);
  for (const FarHit& far : seen.far_hits) {
    const glm::dvec3 point(far.point);
    if (!space.contains(point)) continue;
    const glm::dvec3 direction = point - view;
    const int face = dominant_face(direction);
    const CubeFace frame = CubeFace::of(face);
    const double scale = 1.0 / std::abs(direction[frame.axis]);
    const auto block = [&](int axis) {
      return std::clamp(static_cast<int>(sample_index(edge_samples, direction[axis] * scale)) / kBlockSamples, 0, edge_ - 1);
    };
    hit[(static_cast<std::size_t>(face) * edge_ + block(frame.v_axis())) * edge_ + block(frame.u_axis())] = true;
  }
  blocks_.assign(hit.size(), false);
  for (int face = 0; face < kCubeFaces; ++face)
    for (int y = 0; y < edge_; ++y)
      for (int x = 0; x < edge_; ++x) {
        if (!hit[(static_cast<std::size_t>(face) * edge_ + y) * edge_ + x]) continue;
        for (int ny = std::max(0, y - kGrowth); ny <= std::min(edge_ - 1, y + kGrowth); ++ny)
          for (int nx = std::max(0, x - kGrowth); nx <= std::min(edge_ - 1, x + kGrowth); ++nx)
            blocks_[(static_cast<std::size_t>(face) * edge_ + ny) * edge_ + nx] = true;
      }
}

std::size_t VisibleBlocks::visible() const { return static_cast<std::size_t>(std::count(blocks_.begin(), blocks_.end(), true)); }

}  // namespace farfield

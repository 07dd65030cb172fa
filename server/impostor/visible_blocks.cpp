// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/visible_blocks.h"

#include <algorithm>

namespace farfield {
namespace {

// The probe's viewpoints are half a side apart: what shows only between two of them borders on what they saw.
constexpr int kGrowth = 2;

}  // namespace

std::vector<glm::vec3> points_in_shell(const BoxVisibility& seen, const CellSpace& space) {
  std::vector<glm::vec3> points;
  for (const FarHit& far : seen.far_hits)
    if (space.contains(glm::dvec3(far.point))) points.push_back(far.point);
  return points;
}

VisibleBlocks::VisibleBlocks(std::span<const glm::vec3> in_shell, const glm::dvec3& view, int edge_samples)
    : edge_((edge_samples + kBlockSamples - 1) / kBlockSamples) {
  std::vector<std::uint8_t> hit(static_cast<std::size_t>(kCubeFaces) * edge_ * edge_, 0);
  for (const glm::vec3& point : in_shell) {
    const glm::dvec3 direction = glm::dvec3(point) - view;
    const int face = dominant_face(direction);
    const CubeFace frame = CubeFace::of(face);
    const double scale = 1.0 / std::abs(direction[frame.axis]);
    const auto block = [&](int axis) {
      return std::clamp(static_cast<int>(sample_index(edge_samples, direction[axis] * scale)) / kBlockSamples, 0, edge_ - 1);
    };
    hit[(static_cast<std::size_t>(face) * edge_ + block(frame.v_axis())) * edge_ + block(frame.u_axis())] = 1;
  }
  // Grown along the rows, then along the columns.
  std::vector<std::uint8_t> wide(hit.size(), 0);
  blocks_.assign(hit.size(), 0);
  for (std::size_t row = 0; row < hit.size(); row += static_cast<std::size_t>(edge_))
    for (int x = 0; x < edge_; ++x)
      if (hit[row + x]) std::fill(&wide[row + std::max(0, x - kGrowth)], &wide[row + std::min(edge_ - 1, x + kGrowth)] + 1, 1);
  for (int face = 0; face < kCubeFaces; ++face)
    for (int y = 0; y < edge_; ++y)
      for (int near = std::max(0, y - kGrowth); near <= std::min(edge_ - 1, y + kGrowth); ++near) {
        const std::uint8_t* from = &wide[(static_cast<std::size_t>(face) * edge_ + near) * edge_];
        std::uint8_t* to = &blocks_[(static_cast<std::size_t>(face) * edge_ + y) * edge_];
        for (int x = 0; x < edge_; ++x) to[x] |= from[x];
      }
}

std::size_t VisibleBlocks::visible() const { return static_cast<std::size_t>(std::count(blocks_.begin(), blocks_.end(), 1)); }

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/splat_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/impostor/splats.h"

namespace farfield {
namespace {

/// How much the disparity can change over one sample along the splat's slopes: a slope is a difference to a neighbour,
/// or the mean of two.
class SlopeBounds {
 public:
  explicit SlopeBounds(const Splats& splats) : splats_(splats) {}

  /// Requires: `at` is not below that of the call before.
  float operator()(std::size_t at) {
    const std::vector<SplatLink>& links = splats_.links;
    while (link_ + 1 < links.size() && links[link_ + 1].first <= at) ++link_;
    const float along_u = std::max(to_neighbour(at, 0, at - 1), to_neighbour(at, 4, at + 1));
    const float along_v =
        std::max(to_neighbour(at, 8, at - links[link_].up), to_neighbour(at, 12, at + links[link_].down));
    return along_u + along_v;
  }

 private:
  float to_neighbour(std::size_t at, int shift, std::size_t neighbour) const {
    if ((splats_.reach[at] >> shift & 15) != kReachConnected) return 0;
    return std::fabs(splats_.disparity[neighbour] - splats_.disparity[at]);
  }

  const Splats& splats_;
  std::size_t link_ = 0;
};

/// Samples from `begin` to `at`. Requires: at >= begin.
int samples_between(float begin, float at, float pitch) { return static_cast<int>((at - begin) / pitch + 0.5f); }

}  // namespace

int first_column(const Splats& splats, const SplatRun& run) { return samples_between(splats.u_min, run.u0, splats.pitch); }

SplatBlocks find_blocks(const Splats& splats) {
  SplatBlocks blocks;
  if (splats.runs.empty()) return blocks;
  const int columns = samples_between(splats.u_min, splats.u_max, splats.pitch) + 1;
  const int rows = samples_between(splats.v_min, splats.v_max, splats.pitch) + 1;
  blocks.edge = (std::max(columns, rows) + SplatBlocks::kColumns - 1) / SplatBlocks::kColumns;
  blocks.rows = (rows + blocks.edge - 1) / blocks.edge;
  const std::size_t whole_rows = static_cast<std::size_t>(blocks.rows) * SplatBlocks::kColumns;
  const std::size_t count = whole_rows + SplatBlocks::kColumns;
  blocks.lowest.assign(count, std::numeric_limits<float>::infinity());
  blocks.highest.assign(count, -std::numeric_limits<float>::infinity());
  blocks.first_run.reserve(static_cast<std::size_t>(blocks.rows) + 1);
  SlopeBounds slope(splats);
  for (std::size_t r = 0; r < splats.runs.size(); ++r) {
    const SplatRun& run = splats.runs[r];
    const auto row = static_cast<std::size_t>(samples_between(splats.v_min, run.v, splats.pitch) / blocks.edge);
    while (blocks.first_run.size() <= row) blocks.first_run.push_back(static_cast<std::uint32_t>(r));
    const int column = first_column(splats, run);
    for (int i = 0; i < static_cast<int>(run.count); ++i) {
      const std::size_t at = run.first + static_cast<std::size_t>(i);
      const std::size_t block = row * SplatBlocks::kColumns + static_cast<std::size_t>((column + i) / blocks.edge);
      const float disparity = splats.disparity[at], change = slope(at);
      blocks.lowest[block] = std::min(blocks.lowest[block], disparity - change);
      blocks.highest[block] = std::max(blocks.highest[block], disparity + change);
    }
  }
  blocks.first_run.push_back(static_cast<std::uint32_t>(splats.runs.size()));
  for (std::size_t block = 0; block < whole_rows; ++block) {
    const std::size_t row = whole_rows + block / SplatBlocks::kColumns;
    blocks.lowest[row] = std::min(blocks.lowest[row], blocks.lowest[block]);
    blocks.highest[row] = std::max(blocks.highest[row], blocks.highest[block]);
  }
  return blocks;
}

}  // namespace farfield

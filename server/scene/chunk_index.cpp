// SPDX-License-Identifier: Apache-2.0
#include "server/scene/chunk_index.h"

#include <algorithm>
#include <numeric>

namespace farfield {
namespace {

constexpr std::size_t kFanOut = 8;

// Puts two zero bits between the low 21 bits of x.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

std::uint64_t morton_code(const glm::dvec3& p, const Box& all) {
  const glm::dvec3 extent = all.extent();
  std::uint64_t code = 0;
  for (int a = 0; a < 3; ++a) {
    const double unit = extent[a] > 0 ? std::clamp((p[a] - all.min[a]) / extent[a], 0.0, 1.0) : 0.0;
    code |= spread_bits(static_cast<std::uint64_t>(unit * 2097151.0)) << a;
  }
  return code;
}

}  // namespace

ChunkIndex::ChunkIndex(std::span<const Box> boxes) {
  Box all;
  for (const Box& box : boxes) {
    if (!box.is_empty()) all.include(box);
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].is_empty()) keys.emplace_back(morton_code(boxes[i].center(), all), i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Box> leaves;
  for (const auto& [code, index] : keys) {
    order_.push_back(index);
    leaves.push_back(boxes[index]);
  }
  levels_.push_back(std::move(leaves));
  while (levels_.back().size() > 1) {
    const std::vector<Box>& below = levels_.back();
    std::vector<Box> above((below.size() + kFanOut - 1) / kFanOut);
    for (std::size_t i = 0; i < below.size(); ++i) above[i / kFanOut].include(below[i]);
    levels_.push_back(std::move(above));
  }
}

std::vector<std::uint32_t> ChunkIndex::find(const Box& box) const {
  std::vector<std::uint32_t> found;
  if (order_.empty()) return found;
  struct Node {
    std::size_t level, index;
  };
  std::vector<Node> stack{{levels_.size() - 1, 0}};
  while (!stack.empty()) {
    const auto [level, index] = stack.back();
    stack.pop_back();
    if (!levels_[level][index].intersects(box)) continue;
    if (level == 0) {
      found.push_back(order_[index]);
      continue;
    }
    const std::size_t end = std::min(levels_[level - 1].size(), (index + 1) * kFanOut);
    for (std::size_t child = index * kFanOut; child < end; ++child) stack.push_back({level - 1, child});
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace farfield

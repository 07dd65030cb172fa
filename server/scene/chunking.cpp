// SPDX-License-Identifier: Apache-2.0
#include "server/scene/chunking.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>

namespace farfield {
namespace {

constexpr std::size_t kSerialBelow = 1 << 15;  // smaller subtrees are not worth a task

int longest_axis(std::span<const TriangleItem> items) {
  glm::vec3 low = items.front().centre, high = low;
  for (const TriangleItem& item : items) {
    low = glm::min(low, item.centre);
    high = glm::max(high, item.centre);
  }
  const glm::vec3 edge = high - low;
  return edge.x >= edge.y && edge.x >= edge.z ? 0 : (edge.y >= edge.z ? 1 : 2);
}

void split(std::span<TriangleItem> items, std::size_t max_size) {
  if (items.size() <= max_size) return;
  const std::size_t clusters = (items.size() + max_size - 1) / max_size;
  const std::size_t middle = clusters / 2 * max_size;
  const int axis = longest_axis(items);
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [axis](const TriangleItem& a, const TriangleItem& b) {
                     if (a.centre[axis] < b.centre[axis]) return true;
                     if (b.centre[axis] < a.centre[axis]) return false;
                     return a.triangle < b.triangle;  // a total order: the same clusters every time
                   });
  const auto left = [&] { split(items.first(middle), max_size); };
  const auto right = [&] { split(items.subspan(middle), max_size); };
  if (items.size() < kSerialBelow) {
    left();
    right();
  } else {
    tbb::parallel_invoke(left, right);
  }
}

}  // namespace

std::vector<std::uint32_t> cluster_triangles(std::span<TriangleItem> items, std::uint32_t max_size) {
  split(items, max_size);
  // All splits fall on multiples of max_size, so the runs are known without the tree.
  std::vector<std::uint32_t> ends;
  ends.reserve(items.size() / max_size + 1);
  for (std::size_t end = max_size; end < items.size(); end += max_size) ends.push_back(static_cast<std::uint32_t>(end));
  if (!items.empty()) ends.push_back(static_cast<std::uint32_t>(items.size()));
  return ends;
}

}  // namespace farfield

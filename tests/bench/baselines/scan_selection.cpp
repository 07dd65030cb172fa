// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/scan_selection.h"

#include <algorithm>
#include <numeric>

namespace farfield::bench {

std::vector<std::size_t> select_scans(const ScanTree& tree, const glm::dvec3& eye, const ScanBudget& budget,
                                      std::span<const std::size_t> triangles_in_view) {
  std::vector<std::size_t> by_distance(tree.positions.size());
  std::iota(by_distance.begin(), by_distance.end(), 0);
  std::stable_sort(by_distance.begin(), by_distance.end(),
                   [&](std::size_t a, std::size_t b) { return glm::distance(tree.positions[a], eye) < glm::distance(tree.positions[b], eye); });
  std::vector<std::size_t> selected;
  std::vector<bool> is_selected(tree.positions.size(), false);
  std::size_t triangles = 0;
  for (const std::size_t nearest : by_distance) {
    std::vector<std::size_t> path;  // from the cube up to what is selected already
    for (std::size_t k = nearest; !is_selected[k]; k = tree.parents[k]) {
      path.push_back(k);
      if (tree.parents[k] == k) break;
    }
    for (auto k = path.rbegin(); k != path.rend(); ++k) {
      const bool is_root = selected.empty();
      const bool exceeds_scans = budget.scans > 0 && selected.size() >= budget.scans;
      const bool exceeds_triangles = budget.triangles > 0 && triangles + triangles_in_view[*k] > budget.triangles;
      if (!is_root && (exceeds_scans || exceeds_triangles)) return selected;
      selected.push_back(*k), is_selected[*k] = true;
      triangles += triangles_in_view[*k];
    }
  }
  return selected;
}

}  // namespace farfield::bench

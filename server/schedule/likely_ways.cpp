// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/likely_ways.h"

#include <algorithm>

namespace farfield {

LikelyWays::LikelyWays(const CellGrid& grid, const std::optional<CellId>& previous, const CellId& leaf, const AskDepartures& departures)
    : leaf_(grid.box(leaf)) {
  struct Step {
    std::optional<CellId> previous;
    CellId leaf;
    double probability;
  };
  std::vector<Step> steps{{previous, leaf, 1.0}};
  for (std::size_t next = 0; next < steps.size() && reached_.size() < kMostReached; ++next) {
    const Step step = steps[next];
    const Departures seen = departures(step.previous, step.leaf);
    if (next == 0) is_known_ = seen.seen >= kEnough;
    for (const LikelyNext& way : seen.next) {
      const double probability = step.probability * way.probability;
      const Box box = grid.box(way.leaf);
      const bool is_new = std::none_of(reached_.begin(), reached_.end(), [&](const Reached& there) { return there.box.contains(box.center()); });
      if (!is_new || reached_.size() >= kMostReached) continue;
      reached_.push_back({box, way.entry, probability});
      if (probability >= kLikely) steps.push_back({step.leaf, way.leaf, probability});
    }
  }
}

std::vector<PrefetchTarget> LikelyWays::weighed(std::vector<PrefetchTarget> targets, const glm::dvec3& from, double speed_m_s) const {
  if (is_known_) {
    std::erase_if(targets, [&](const PrefetchTarget& target) {
      return !leaf_.contains(target.viewpoint) &&
             std::none_of(reached_.begin(), reached_.end(), [&](const Reached& there) { return there.box.contains(target.viewpoint); });
    });
  }
  for (const Reached& there : reached_) {
    if (there.probability < kLikely || speed_m_s <= 0) continue;
    const bool is_listed = std::any_of(targets.begin(), targets.end(), [&](const PrefetchTarget& target) { return there.box.contains(target.viewpoint); });
    if (!is_listed) targets.push_back({there.entry, glm::distance(from, there.entry) / speed_m_s, 0});
  }
  std::stable_sort(targets.begin(), targets.end(), [](const PrefetchTarget& a, const PrefetchTarget& b) { return a.seconds_until_needed < b.seconds_until_needed; });
  return targets;
}

}  // namespace farfield

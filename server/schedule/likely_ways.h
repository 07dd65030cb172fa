// SPDX-License-Identifier: Apache-2.0
// What earlier viewers' ways say about a predicted path: which of its places hardly anybody went to, and where most went instead.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "server/schedule/prefetch_planner.h"
#include "server/schedule/transition_table.h"

namespace farfield {

/// For one look ahead. Keeps no reference to what it was made of but `departures`.
class LikelyWays {
 public:
  using AskDepartures = std::function<Departures(const std::optional<CellId>& previous, const CellId& leaf)>;

  /// Follows the likely departures from `leaf` for a few leaves. O(leaves within reach).
  LikelyWays(const CellGrid& grid, const std::optional<CellId>& previous, const CellId& leaf, const AskDepartures& departures);

  /// The targets worth preparing, soonest first: a target is dropped if enough viewers left this leaf and none of them came where it
  /// lies; where a good share went and no target lies, one is added, reached at `speed` m/s from `from`.
  std::vector<PrefetchTarget> weighed(std::vector<PrefetchTarget> targets, const glm::dvec3& from, double speed_m_s) const;

 private:
  struct Reached {
    Box box;
    glm::dvec3 entry{0};
    double probability = 0;
  };
  /// With fewer departures than this a place nobody went to is still as likely as one in four or more (Laplace's rule of succession).
  static constexpr std::uint64_t kEnough = 4;
  static constexpr double kLikely = 0.25;    // of a place worth adding, and of a way worth following
  static constexpr std::size_t kMostReached = 16;

  Box leaf_;        // where the viewer is: nothing within it is dropped
  bool is_known_ = false;          // enough viewers left the leaf
  std::vector<Reached> reached_;   // by any of them, and from there on by most
};

}  // namespace farfield

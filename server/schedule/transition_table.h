// SPDX-License-Identifier: Apache-2.0
// Where viewers went: how often each leaf was entered from which, counted over all viewers of a scene, so that the next one's way is known
// where the straight line only guesses.
//
// A Markov chain of second order (the leaf before and the leaf now give the direction), of first order where that was never seen:
// Rabiner 1989, "A tutorial on hidden Markov models", section II, for the terms. Counts are halved when they grow large, so that new
// habits replace old ones.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/cells/cell_id.h"

namespace farfield {

/// A leaf that viewers went to, and how likely the next one does.
struct LikelyNext {
  CellId leaf;
  glm::dvec3 entry{0};     // where the last of them entered it, scene frame
  double probability = 0;  // its share of the departures, as if one more had gone nowhere seen yet
};

struct Departures {
  std::uint64_t seen = 0;            // of viewers who left the leaf
  std::vector<LikelyNext> next;      // most likely first
};

/// Thread-safe.
class TransitionTable {
 public:
  /// `capacity`: pairs of leaves remembered; when there are more, those with the fewest departures go.
  explicit TransitionTable(std::size_t capacity = 50'000) : capacity_(capacity) {}

  /// A viewer who had come from `previous` (if that is known) left `current` for `next`, entering it at `entry`. Requires: finite.
  void note(const std::optional<CellId>& previous, const CellId& current, const CellId& next, const glm::dvec3& entry);
  /// Of viewers who came the same way; if none were seen, of all who were in `current`.
  Departures from(const std::optional<CellId>& previous, const CellId& current) const;

  /// All of it, for the next start.
  Bytes write() const;
  /// Replaces what is here; any bytes are safe. Errors: kBadData, and nothing is changed.
  Status read(ByteView bytes);
  /// Notes since it was made or read: whether writing is worth while.
  std::uint64_t noted() const;

 private:
  struct Way {
    CellId previous, current;  // previous: kNowhere for the first order
    bool operator==(const Way&) const = default;
  };
  struct WayHash {
    std::size_t operator()(const Way& way) const { return std::hash<CellId>()(way.previous) * 31 + std::hash<CellId>()(way.current); }
  };
  struct Count {
    CellId leaf;
    glm::dvec3 entry{0};
    std::uint32_t count = 0;
  };
  struct Row {
    std::uint32_t total = 0;
    std::vector<Count> counts;
  };
  static constexpr CellId kNowhere{.level = 255};
  static constexpr std::uint32_t kMostCounted = 1 << 16;
  static constexpr std::size_t kMostNext = 64;  // of one leaf; a leaf has few neighbours

  static void add(Row& row, const CellId& next, const glm::dvec3& entry);
  void make_room();

  const std::size_t capacity_;
  mutable std::mutex mutex_;  // guards everything below
  std::unordered_map<Way, Row, WayHash> rows_;
  std::uint64_t noted_ = 0;
};

}  // namespace farfield

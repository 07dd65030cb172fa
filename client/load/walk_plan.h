// SPDX-License-Identifier: Apache-2.0
// Where simulated viewers go: recorded paths, made ones, or all of them one behind the other.
//
// Recorded paths are walked to their end, back, and so on, turning round at both; viewers share them, each entering at another
// place. A random walk keeps its height and its speed and wanders within some metres of the start: it knows no walls, so a
// scene with rooms is better tested with recorded paths.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/trace/trace.h"

namespace farfield::client {

struct WalkOptions {
  enum class Kind { kRandom, kTraces, kHerd };
  Kind kind = Kind::kRandom;
  std::filesystem::path traces;  // a file, or a folder of *.trace; of a herd: the way it takes, empty for a random one
  double speed_m_s = 0;          // 0: recorded paths as they were, random ones 1.4
  std::uint64_t seed = 1;
};

/// "random", "trace:FILE-OR-FOLDER", "herd", "herd:FILE". Errors: kInvalidArgument.
Result<WalkOptions> parse_walk(std::string_view text);

/// One viewer's way over time. Immutable.
class WalkPath {
 public:
  /// `path`: world frame, at least one pose. `rate`: of its clock to the viewer's. `begin_s`: where on it the viewer enters.
  WalkPath(std::shared_ptr<const Trace> path, double rate, double begin_s) : path_(std::move(path)), rate_(rate), begin_s_(begin_s) {}
  /// World pose after `seconds` of walking; any number of them.
  Pose at(double seconds) const;

 private:
  std::shared_ptr<const Trace> path_;
  double rate_, begin_s_;
};

/// Thread-safe once made.
class WalkPlan {
 public:
  /// Reads what `options` name. Errors: kIo, kBadData, kNotFound (a folder without traces).
  static Result<WalkPlan> load(const WalkOptions& options);
  /// The way of viewer number `index` in a scene within `bounds` where one can stand at `start`, both in the world.
  WalkPath path_of(std::size_t index, const Box& bounds, const glm::dvec3& start) const;

 private:
  explicit WalkPlan(WalkOptions options) : options_(std::move(options)) {}
  double rate_of(const Trace& trace) const;

  WalkOptions options_;
  std::vector<std::shared_ptr<const Trace>> traces_;
};

/// At `speed_m_s`, no farther than `reach_m` from `start` and within `bounds`, at its height; ten poses a second.
Trace random_walk(const Box& bounds, const glm::dvec3& start, double speed_m_s, double seconds, double reach_m, std::uint64_t seed);

}  // namespace farfield::client

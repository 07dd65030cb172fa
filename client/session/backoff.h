// SPDX-License-Identifier: Apache-2.0
// How long to wait before connecting again: doubling, with jitter, so that a thousand clients that lost one server do
// not return in one instant.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>

namespace farfield::client {

class Backoff {
 public:
  using Milliseconds = std::chrono::milliseconds;
  static constexpr Milliseconds kShortest{100};
  static constexpr Milliseconds kLongest{5000};

  explicit Backoff(std::uint64_t seed) : random_(seed) {}

  /// Uniform in [limit/2, limit], limit = 0.1 s doubled with each call up to 5 s; never below `at_least`.
  Milliseconds next(Milliseconds at_least = Milliseconds(0)) {
    std::uniform_int_distribution<std::int64_t> jitter(limit_.count() / 2, limit_.count());
    const Milliseconds wait = std::max(kShortest, Milliseconds(jitter(random_)));
    limit_ = std::min(kLongest, 2 * limit_);
    // A server that names a time gets the jitter on top of it, for the same reason.
    return at_least.count() > 0 ? at_least + wait : wait;
  }
  /// After a connection that worked.
  void reset() { limit_ = kFirst; }

 private:
  static constexpr Milliseconds kFirst{200};
  std::mt19937_64 random_;
  Milliseconds limit_ = kFirst;
};

}  // namespace farfield::client

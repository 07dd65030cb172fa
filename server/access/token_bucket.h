// SPDX-License-Identifier: Apache-2.0
// A rate limit: so many per second, with a burst of one second's worth or as told. The clock is handed in.
#pragma once

#include <algorithm>
#include <chrono>

namespace farfield {

class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;

  explicit TokenBucket(double per_second) : TokenBucket(per_second, per_second) {}
  /// Requires: a burst of at least one.
  TokenBucket(double per_second, double burst) : per_second_(per_second), burst_(burst), tokens_(burst) {}

  /// Returns: whether one more is allowed now.
  bool take(Clock::time_point now) {
    refill(now);
    if (tokens_ < 1) return false;
    tokens_ -= 1;
    return true;
  }
  /// Whether take() would succeed.
  bool has(Clock::time_point now) {
    refill(now);
    return tokens_ >= 1;
  }
  bool is_full(Clock::time_point now) {
    refill(now);
    return tokens_ >= burst_;
  }
  /// How long until take() will succeed.
  Clock::duration wait(Clock::time_point now) {
    refill(now);
    const double seconds = tokens_ < 1 ? (1 - tokens_) / per_second_ : 0;
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)) + Clock::duration(1);
  }

 private:
  void refill(Clock::time_point now) {
    if (last_ != Clock::time_point{} && now > last_) {
      const double gained = std::chrono::duration<double>(now - last_).count() * per_second_;
      tokens_ = std::min(burst_, tokens_ + gained);
    }
    last_ = std::max(last_, now);
  }

  double per_second_, burst_, tokens_;
  Clock::time_point last_{};
};

}  // namespace farfield

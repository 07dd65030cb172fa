// SPDX-License-Identifier: Apache-2.0
// Frame times of a run: quantiles over all, and a line about the last quarter second for the window's title.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace farfield::client {

class FrameClock {
 public:
  void add(double frame_ms) {
    // Bounded: beyond an hour at 60 frames per second the oldest are overwritten.
    if (times_ms_.size() < kMost) {
      times_ms_.push_back(frame_ms);
    } else {
      times_ms_[static_cast<std::size_t>(frames_ % kMost)] = frame_ms;
    }
    ++frames_;
  }
  std::uint64_t frames() const { return frames_; }
  /// `share` 0 … 1; 0.5 is the median. 0 without frames.
  double quantile_ms(double share) const {
    if (times_ms_.empty()) return 0;
    std::vector<double> sorted(times_ms_);
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1) + 0.5);
    std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
    return sorted[static_cast<std::size_t>(at)];
  }

 private:
  static constexpr std::size_t kMost = 216'000;
  std::vector<double> times_ms_;
  std::uint64_t frames_ = 0;
};

}  // namespace farfield::client

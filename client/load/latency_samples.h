// SPDX-License-Identifier: Apache-2.0
// Latencies of one kind, and their percentiles. Every sample is kept: the tail is what a load test is for.
#pragma once

#include <cstddef>
#include <vector>

namespace farfield::client {

struct Percentiles {
  double p50 = 0, p90 = 0, p95 = 0, p99 = 0, p999 = 0, max = 0;
};

/// Not thread-safe.
class LatencySamples {
 public:
  void add(double seconds) { seconds_.push_back(seconds); }
  void add(const LatencySamples& others) { seconds_.insert(seconds_.end(), others.seconds_.begin(), others.seconds_.end()); }
  std::size_t count() const { return seconds_.size(); }
  /// Seconds; nearest rank, so that each is a sample that was met. NaN without samples. O(n).
  Percentiles percentiles() const;

 private:
  std::vector<double> seconds_;
};

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// How long things took, as counts per range: small, fixed, and mergeable into a Prometheus histogram.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace farfield {

struct DurationHistogram {
  /// Upper ends of the ranges in seconds, inclusive; one more range reaches to infinity.
  static constexpr std::array<double, 12> kUpperEnds_s{0.0005, 0.001, 0.002, 0.005, 0.01, 0.02,
                                                       0.05,   0.1,   0.2,   0.5,   1.0,  2.0};

  std::array<std::uint64_t, kUpperEnds_s.size() + 1> counts{};
  std::uint64_t count = 0;
  double sum_s = 0;
  double max_s = 0;

  void add(double seconds) {
    const auto range = std::lower_bound(kUpperEnds_s.begin(), kUpperEnds_s.end(), seconds);
    ++counts[static_cast<std::size_t>(range - kUpperEnds_s.begin())];
    ++count;
    sum_s += seconds;
    max_s = std::max(max_s, seconds);
  }
  double mean_s() const { return count ? sum_s / static_cast<double>(count) : 0.0; }
};

}  // namespace farfield

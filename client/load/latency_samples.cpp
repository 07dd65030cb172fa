// SPDX-License-Identifier: Apache-2.0
#include "client/load/latency_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace farfield::client {

Percentiles LatencySamples::percentiles() const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (seconds_.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone};
  std::vector<double> sorted = seconds_;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
  };
  return {at(0.5), at(0.9), at(0.95), at(0.99), at(0.999), sorted.back()};
}

}  // namespace farfield::client

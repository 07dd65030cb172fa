// SPDX-License-Identifier: Apache-2.0
// Percentiles of a handful of measurements.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace farfield::bench {

/// Nearest-rank percentile, `share` in [0, 1]; NaN of nothing.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}
inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
}
inline double largest(const std::vector<double>& values) {
  return values.empty() ? std::nan("") : *std::max_element(values.begin(), values.end());
}
inline double smallest(const std::vector<double>& values) {
  return values.empty() ? std::nan("") : *std::min_element(values.begin(), values.end());
}

}  // namespace farfield::bench

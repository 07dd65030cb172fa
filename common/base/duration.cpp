// SPDX-License-Identifier: Apache-2.0
#include "common/base/duration.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

namespace farfield {

Result<std::chrono::seconds> parse_duration(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 6> kUnits{{{"", 1}, {"s", 1}, {"m", 60}, {"min", 60}, {"h", 3600}, {"d", 86400}}};
  constexpr double kMost = 100 * 365.25 * 86400;
  const std::string copy(text);
  char* end = nullptr;
  const double number = std::strtod(copy.c_str(), &end);
  for (const auto& [unit, seconds] : kUnits) {
    if (end == copy.c_str() || unit != end) continue;
    if (!std::isfinite(number) || number * seconds < 1 || number * seconds > kMost) break;
    return std::chrono::seconds(std::llround(number * seconds));
  }
  return fail(ErrorCode::kInvalidArgument, "'{}' is no length of time: write for example 90s, 12h or 7d", text);
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/base/byte_size.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace farfield {

Result<std::size_t> parse_byte_size(std::string_view text) {
  const auto refuse = [&] {
    return fail(ErrorCode::kInvalidArgument, "'{}' is no size: write for example 512MiB or 4GiB", text);
  };
  const std::string copy(text);
  char* end = nullptr;
  const double number = std::strtod(copy.c_str(), &end);
  if (end == copy.c_str() || !std::isfinite(number) || number < 0) return refuse();
  std::string unit(end);
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::tolower(c); });
  double factor = 1;
  if (!unit.empty() && unit != "b") {
    const std::size_t power = std::string_view("kmgt").find(unit[0]);
    const std::string rest = unit.substr(1);
    if (power == std::string_view::npos || !(rest.empty() || rest == "b" || rest == "ib")) return refuse();
    factor = std::pow(rest == "b" ? 1000.0 : 1024.0, static_cast<double>(power + 1));
  }
  constexpr double kMost = 1e18;  // below 2^63
  if (number * factor > kMost) return refuse();
  return static_cast<std::size_t>(number * factor);
}

}  // namespace farfield

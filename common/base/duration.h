// SPDX-License-Identifier: Apache-2.0
// Times as people write them on command lines: "90s", "15min", "12h", "7d".
#pragma once

#include <chrono>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

/// Units s, min (or m), h, d; whole seconds at least, without a unit seconds; up to a hundred years. Errors: kInvalidArgument.
Result<std::chrono::seconds> parse_duration(std::string_view text);

}  // namespace farfield

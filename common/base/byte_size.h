// SPDX-License-Identifier: Apache-2.0
// Sizes as people write them on command lines: "4GiB", "512MB", "1000000".
#pragma once

#include <cstddef>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

/// Units B, KB, MB, GB, TB (factors of 1000) and KiB, MiB, GiB, TiB (factors of 1024), also K, M, G, T (as KiB …),
/// any case, with or without a fraction. Errors: kInvalidArgument.
Result<std::size_t> parse_byte_size(std::string_view text);

}  // namespace farfield

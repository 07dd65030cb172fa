// SPDX-License-Identifier: Apache-2.0
// farfield-token: makes access tokens and keeps the server's list of them.
#pragma once

#include <iosfwd>

namespace farfield {

/// Returns: the exit code. A new token goes to `out` or a file that only its owner can read, and nowhere else.
int run_token_tool(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk);

}  // namespace farfield

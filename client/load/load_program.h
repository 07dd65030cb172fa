// SPDX-License-Identifier: Apache-2.0
// farfield-load: many clients without a screen against one server. Report on stdout, talk on stderr.
#pragma once

#include <iosfwd>

namespace farfield::client {

/// The whole program. Returns: 0 done and every threshold met, 1 failed or a threshold missed (a line each on `talk`), 2 wrong
/// usage, 130 interrupted.
int run_load_program(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk);

}  // namespace farfield::client

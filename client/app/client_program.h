// SPDX-License-Identifier: Apache-2.0
// farfield-client: connects, then walks in a window or replays a trace without one.
#pragma once

#include <iosfwd>

#include "client/app/options.h"

namespace farfield::client {

/// Figures and --help go to `out`, talk to `talk`. Returns: the exit code, 0, 1, 2 or 130.
int run_client(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk);

}  // namespace farfield::client

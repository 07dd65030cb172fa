// SPDX-License-Identifier: Apache-2.0
// Farfield itself, over a real socket: the real server in this process, the real client in another.
#pragma once

#include "tests/bench/method.h"

namespace farfield::bench {

/// `renderer`: "cpu" or "gl". Two runs from cold caches: lockstep, then real time over the link model.
/// Knobs: the command line's quality flags. Errors: the client's, in one line.
Method farfield_method(const std::string& renderer, const BenchOptions& defaults);

}  // namespace farfield::bench

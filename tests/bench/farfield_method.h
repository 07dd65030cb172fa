// SPDX-License-Identifier: Apache-2.0
// Farfield itself, over a real socket: the real server in this process, the real client in another.
#pragma once

#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// `renderer`: "cpu" or "gl". Two runs from cold caches: lockstep, then real time over the link model.
/// Errors: the client's, in one line.
Result<MethodResult> run_farfield(const World& world, const std::string& renderer);

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// The measured client: the real client core and renderer in a process of their own, so that its memory is its own.
#pragma once

#include "tests/bench/bench_options.h"

namespace farfield::bench {

/// Walks the trace, dumps the sampled frames into role.folder and prints one JSON object on standard output.
/// Returns: the exit code.
int run_client_role(const ClientRole& role);

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// All methods there are, in the order of --help.
#pragma once

#include "tests/bench/method.h"

namespace farfield::bench {

/// Farfield's knobs begin where the command line's flags of the same names put them.
std::vector<Method> all_methods(const BenchOptions& options);

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// The benchmark from options to report.
#pragma once

#include "common/base/result.h"
#include "tests/bench/bench_options.h"

namespace farfield::bench {

/// Table on standard output (or JSON, if it was asked for there), progress on standard error.
Status run_bench(const BenchOptions& options);

}  // namespace farfield::bench

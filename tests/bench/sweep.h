// SPDX-License-Identifier: Apache-2.0
// One method run once for each of several values of a knob, on one trace and one truth.
#pragma once

#include "tests/bench/curve.h"
#include "tests/bench/method.h"

namespace farfield::bench {

/// "METHOD:KNOB=a,b,c". Errors: kInvalidArgument, one line: the form, or a method, knob or value that is not there.
Result<Sweep> parse_sweep(const std::string& text, std::span<const Method> methods);

/// Errors: the method's.
Result<Curve> run_sweep(const World& world, std::span<const Method> methods, const Sweep& sweep);

}  // namespace farfield::bench

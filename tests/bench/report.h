// SPDX-License-Identifier: Apache-2.0
// The report: JSON for programs (format farfield-bench/1), one table and a picture for people.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>

#include "tests/bench/curve.h"
#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

nlohmann::json to_json(const World& world, const std::vector<MethodResult>& methods, const std::vector<Curve>& curves);
void print_table(const std::vector<MethodResult>& methods, std::ostream& out);
/// Per axis of cost, where Farfield's methods (all their curves and runs taken together) do not lie below and left of
/// another method's curve or run, or that they do. Empty if Farfield or all others did not run.
void print_dominance(const std::vector<MethodResult>& methods, const std::vector<Curve>& curves, std::ostream& out);
/// Two panels, frame time and bytes per second against FLIP: a point per method, a line per curve, its knee in a ring.
/// Errors: kIo.
Status write_plot(const std::filesystem::path& file, const std::vector<MethodResult>& methods, const std::vector<Curve>& curves);
/// All frames of all methods and truth, NNNN-METHOD.png. Requires: the folder exists. Errors: kIo.
Status write_frames(const std::filesystem::path& folder, const World& world, const std::vector<MethodResult>& methods);
/// Rows: each method's frames, then truth; columns: up to six frames of the trace. Errors: kIo.
Status write_contact_sheet(const std::filesystem::path& file, const World& world, const std::vector<MethodResult>& methods);

}  // namespace farfield::bench

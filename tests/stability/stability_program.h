// SPDX-License-Identifier: Apache-2.0
// farfield-stability: the stresses of the suite as one table (input, reference, worst error, bound, holds).
#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json.hpp>

#include "common/base/result.h"
#include "tests/stability/stress.h"

namespace farfield::stability {

struct ProgramOptions {
  Effort effort;
  std::vector<std::string> only;  // names of stresses; empty: all
  std::filesystem::path json;     // "-": to standard output, instead of the table
};

struct StressResult {
  std::string name, what;
  Rows rows;
};

/// Runs the chosen stresses one after another. Returns: their rows, in the table's order.
std::vector<StressResult> run_stresses(const ProgramOptions& options);
/// Whether every row of every stress holds; false without any row.
bool all_hold(const std::vector<StressResult>& results);
/// Format farfield-stability/1.
nlohmann::json to_json(const std::vector<StressResult>& results, const Effort& effort);
/// A Markdown table.
void print_table(const std::vector<StressResult>& results, std::ostream& out);

/// The whole program. Returns: 0 every bound holds, 1 one is broken or something failed, 2 wrong usage.
int run_program(int argument_count, const char* const* arguments);

}  // namespace farfield::stability

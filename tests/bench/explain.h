// SPDX-License-Identifier: Apache-2.0
// What the server left out on a walk and why, cell by cell: farfield-bench --explain.
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <span>

#include "tests/bench/method_result.h"

namespace farfield::bench {

/// Of more cells than this only the first are told about, in the order of explained_cells().
inline constexpr std::size_t kMostExplained = 256;

/// Leaves first, then the cells around them, each by name; at most kMostExplained.
std::vector<CellStatistics> explained_cells(std::vector<CellStatistics> cells);

/// One object per cell and method. Keys: tests/bench/README.md.
nlohmann::json explain_json(std::span<const MethodResult> methods);
/// A line per cell, what each column counts and why, and what it saved. Nothing for methods that explain nothing.
void print_explanation(const MethodResult& method, std::ostream& out);

}  // namespace farfield::bench

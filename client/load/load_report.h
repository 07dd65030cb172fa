// SPDX-License-Identifier: Apache-2.0
// What a load test found: for programs ("farfield-load/1", described in docs/load.md) and for people.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "client/load/load_run.h"

namespace farfield::client {

/// Leaf plans the server made during the test; nothing if it was not asked.
using CellsMade = std::optional<std::uint64_t>;

nlohmann::json load_report(const LoadOptions& options, const LoadOutcome& outcome, const CellsMade& made);
/// `report`: of load_report().
void print_load_report(const nlohmann::json& report, std::ostream& out);

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// The report: JSON for programs (format farfield-bench/1), one table and a picture for people.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>

#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

nlohmann::json to_json(const World& world, const std::vector<MethodResult>& methods);
void print_table(const std::vector<MethodResult>& methods, std::ostream& out);
/// Frame time against FLIP, one point per method. Errors: kIo.
Status write_plot(const std::filesystem::path& file, const std::vector<MethodResult>& methods);
/// All frames of all methods and truth, NNNN-METHOD.png. Requires: the folder exists. Errors: kIo.
Status write_frames(const std::filesystem::path& folder, const World& world, const std::vector<MethodResult>& methods);
/// Rows: each method's frames, then truth; columns: up to six frames of the trace. Errors: kIo.
Status write_contact_sheet(const std::filesystem::path& file, const World& world, const std::vector<MethodResult>& methods);

}  // namespace farfield::bench

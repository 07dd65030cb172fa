// SPDX-License-Identifier: Apache-2.0
#include "tests/stability/stability_program.h"

#include <algorithm>
#include <iostream>
#include <sstream>

#include "common/base/command_line.h"
#include "common/base/complete_file.h"

namespace farfield::stability {
namespace {

constexpr const char* kFooter = R"(Examples:
  farfield-stability
  farfield-stability --full --json stability.json
  farfield-stability --only leaks --leak-rays 100000000

Exit codes: 0 every bound holds, 1 one is broken or the report cannot be written, 2 wrong usage.)";

std::string names() {
  std::string all;
  for (const Stress& stress : all_stresses()) all += fmt::format("{}{}", all.empty() ? "" : ", ", stress.name);
  return all;
}

bool is_known(const std::string& name) {
  return std::any_of(all_stresses().begin(), all_stresses().end(), [&](const Stress& stress) { return stress.name == name; });
}

Status write(const std::vector<StressResult>& results, const ProgramOptions& options) {
  const std::string json = to_json(results, options.effort).dump(2) + '\n';
  if (options.json == "-") {
    std::cout << json;
  } else {
    print_table(results, std::cout);
    if (!options.json.empty())
      if (Status status = write_complete_file(options.json, json); !status) return status;
  }
  if (!std::cout.flush()) return fail(ErrorCode::kIo, "the report cannot be written to the output");
  return {};
}

}  // namespace

std::vector<StressResult> run_stresses(const ProgramOptions& options) {
  std::vector<StressResult> results;
  for (const Stress& stress : all_stresses()) {
    const bool is_wanted = options.only.empty() || std::find(options.only.begin(), options.only.end(), stress.name) != options.only.end();
    if (is_wanted) results.push_back({stress.name, stress.what, stress.run(options.effort)});
  }
  return results;
}

bool all_hold(const std::vector<StressResult>& results) {
  std::size_t rows = 0;
  for (const StressResult& result : results)
    for (const StressRow& row : result.rows) {
      if (!row.holds()) return false;
      ++rows;
    }
  return rows > 0;
}

nlohmann::json to_json(const std::vector<StressResult>& results, const Effort& effort) {
  nlohmann::json list = nlohmann::json::array();
  for (const StressResult& result : results)
    for (const StressRow& row : result.rows) {
      nlohmann::json entry{{"stress", result.name}, {"input", row.input}, {"reference", row.reference}, {"unit", row.unit},
                           {"bound", row.bound},    {"cases", row.cases}, {"holds", row.holds()}};
      // JSON knows no infinity: what could not be compared at all is null.
      entry["worst"] = std::isfinite(row.worst) ? nlohmann::json(row.worst) : nlohmann::json();
      list.push_back(std::move(entry));
    }
  return {{"format", "farfield-stability/1"},
          {"full", effort.is_full},
          {"leak_rays", effort.leak_rays},
          {"holds", all_hold(results)},
          {"rows", list}};
}

void print_table(const std::vector<StressResult>& results, std::ostream& out) {
  out << "| input | reference | worst error | bound | unit | cases | holds |\n| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const StressResult& result : results) {
    out << fmt::format("| **{}**: {} | | | | | | |\n", result.name, result.what);
    for (const StressRow& row : result.rows)
      out << fmt::format("| {} | {} | {:.4g} | {:.4g} | {} | {} | {} |\n", row.input, row.reference, row.worst, row.bound, row.unit,
                         row.cases, row.holds() ? "yes" : "NO");
  }
}

int run_program(int argument_count, const char* const* arguments) {
  CLI::App app{"Stresses the numerics of Farfield and compares with exact or long double references, row by row.", "farfield-stability"};
  app.footer(kFooter);
  app.set_version_flag("--version", "farfield-stability " FARFIELD_VERSION);
  ProgramOptions options;
  bool is_full = false;
  std::uint64_t leak_rays = 0;
  std::string only;
  app.add_flag("--full", is_full, "Many more cases, and 10^8 rays at edges and vertices: some minutes");
  app.add_option("--leak-rays", leak_rays, "Rays at edges and vertices; 0: 10^6, with --full 10^8")
      ->check(whole_number_between(0, 1'000'000'000'000));
  app.add_option("--only", only, "Stresses to run, separated by commas, of " + names());
  app.add_option("--json", options.json, "Write the rows here, format farfield-stability/1; - for standard output instead of the table");
  if (const std::optional<int> over = parse_command_line(app, argument_count, arguments, std::cout, std::cerr)) return *over;
  if (is_full) options.effort = Effort::full();
  if (leak_rays > 0) options.effort.leak_rays = leak_rays;
  std::stringstream list(only);
  for (std::string name; std::getline(list, name, ',');) {
    if (!is_known(name)) {
      complain(std::cerr, app.get_name(), "--only: there is no '" + name + "' (see --help)");
      return 2;
    }
    options.only.push_back(name);
  }
  if (!options.json.empty() && options.json != "-")
    if (Status status = check_file_can_be_written(options.json); !status) {
      complain(std::cerr, app.get_name(), status.error().message);
      return 1;
    }
  const std::vector<StressResult> results = run_stresses(options);
  if (const Status status = write(results, options); !status) {
    complain(std::cerr, app.get_name(), status.error().message);
    return 1;
  }
  return all_hold(results) ? 0 : 1;
}

}  // namespace farfield::stability

// SPDX-License-Identifier: Apache-2.0
// farfield-calibration: how certificates' promises compare with what farfield-bench measured.
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/base/complete_file.h"
#include "common/base/one_line.h"
#include "tests/bench/calibration.h"

int main(int argc, char** argv) {
  using namespace farfield;
  CLI::App app("Reads reports that farfield-bench --json wrote, prints how often and how closely frames kept what their impostors promised, and plots it.");
  std::vector<std::filesystem::path> reports;
  std::filesystem::path plot;
  app.add_option("reports", reports, "JSON files")->required();
  app.add_option("--plot", plot, "write promise against measurement here, SVG");
  CLI11_PARSE(app, argc, argv);
  const auto complain = [](const Error& error) {
    std::cerr << "farfield-calibration: " << one_line(error.message) << '\n';
    return 1;
  };
  std::vector<bench::CalibrationRun> runs;
  for (const std::filesystem::path& report : reports) {
    auto read = bench::read_calibration(report);
    if (!read) return complain(read.error());
    runs.insert(runs.end(), read->begin(), read->end());
  }
  std::cout << bench::calibration_table(runs);
  if (plot.empty()) return 0;
  if (const Status status = write_complete_file(plot, bench::calibration_plot(runs)); !status) return complain(status.error());
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// From reports of farfield-bench to the calibration of certificates: what frames promised beside what was measured.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "tests/bench/method_result.h"

namespace farfield::bench {

/// The frames of one method in one report.
struct CalibrationRun {
  std::string name;  // scene and method
  std::vector<KeptPromise> frames;
};

/// Runs without promises are left out. Errors: kIo, kBadData.
Result<std::vector<CalibrationRun>> read_calibration(const std::filesystem::path& report);
/// Three panels, promise across and measurement up, with the line on which they are equal; a series per run.
std::string calibration_plot(std::span<const CalibrationRun> runs);
/// One line per run and one for all: share of frames that keep their promise, by figure, and the means of both.
std::string calibration_table(std::span<const CalibrationRun> runs);

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// The command line of farfield-load.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "client/load/load_run.h"
#include "client/load/threshold.h"

namespace farfield::client {

struct LoadProgramOptions {
  LoadOptions load;
  std::vector<Threshold> thresholds;
  std::optional<Endpoint> admin;  // of the server, asked how many cells it made
  std::string json;               // file for the report, "-": standard output
  bool is_quiet = false;
};

/// Returns: the options, or the exit code of a program that is not to go on.
tl::expected<LoadProgramOptions, int> parse_load_options(int argument_count, const char* const* arguments, std::ostream& out, std::ostream& talk);

/// "20/s", "90/min", "20": arrivals per second. Errors: kInvalidArgument.
Result<double> parse_arrival(std::string_view text);

}  // namespace farfield::client

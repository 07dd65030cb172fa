// SPDX-License-Identifier: Apache-2.0
// The options of every program that loads models: how the file's coordinates become metres, and what loading may cost.
#pragma once

#include "common/base/command_line.h"
#include "server/model/load_model.h"

namespace farfield {

/// Must outlive the parsing of the command it was added to.
class LoadArguments {
 public:
  void add_to(CLI::App& command) {
    command.add_option("--units", load_.metres_per_unit, "Metres per unit of the model file (default: what it says, else 1)")
        ->check(number_between(1e-9, 1e9));
    command.add_option("--up", load_.up, "Axis that points up in the model file (default y; z for CityJSON)")
        ->check(CLI::IsMember({"x", "y", "z"}));
    command.add_option("--shift", shift_, "Metres added to every position after units and up, as X,Y,Z")
        ->delimiter(',')
        ->expected(3)
        ->check(number_between(-1e12, 1e12));
    command.add_option("--memory-gb", memory_gb_, "Memory the import process may use (default 8)")
        ->check(whole_number_between(1, 1024));
  }
  /// After parsing.
  LoadOptions options() const {
    LoadOptions result = load_;
    if (shift_.size() == 3) result.shift = {shift_[0], shift_[1], shift_[2]};
    result.memory_limit_bytes = std::size_t{memory_gb_} << 30;
    return result;
  }

 private:
  LoadOptions load_;
  std::vector<double> shift_;
  unsigned memory_gb_ = 8;
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// farfield-load: see load_program.h.
#include <exception>
#include <iostream>

#include "client/load/load_program.h"
#include "common/base/one_line.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::client::run_load_program(argument_count, arguments, std::cout, std::cerr);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-load", exception.what());
    return 1;
  }
}

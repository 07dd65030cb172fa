// SPDX-License-Identifier: Apache-2.0
// farfield-stability: see stability_program.h.
#include <exception>
#include <iostream>

#include "common/base/one_line.h"
#include "tests/stability/stability_program.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::stability::run_program(argument_count, arguments);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-stability", exception.what());
    return 1;
  }
}

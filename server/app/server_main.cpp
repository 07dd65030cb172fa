// SPDX-License-Identifier: Apache-2.0
// farfield-server: see server_program.h.
#include <exception>
#include <iostream>

#include "common/base/one_line.h"
#include "server/app/server_program.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::run_server_program(argument_count, arguments);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-server", exception.what());
    return 1;
  }
}

// SPDX-License-Identifier: Apache-2.0
// farfield-bake: see bake_tool.h.
#include <exception>
#include <iostream>

#include "common/base/one_line.h"
#include "server/app/bake_tool.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::run_bake_tool(argument_count, arguments);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-bake", exception.what());
    return 1;
  }
}

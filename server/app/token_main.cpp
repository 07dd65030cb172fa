// SPDX-License-Identifier: Apache-2.0
// farfield-token: see token_tool.h.
#include <exception>
#include <iostream>

#include "common/base/one_line.h"
#include "server/app/token_tool.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::run_token_tool(argument_count, arguments, std::cout, std::cerr);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-token", exception.what());
    return 1;
  }
}

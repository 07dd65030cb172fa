// SPDX-License-Identifier: Apache-2.0
// farfield-trace: see trace_tool.h.
#include <exception>
#include <iostream>

#include "common/base/one_line.h"
#include "server/app/trace_tool.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::run_trace_tool(argument_count, arguments);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-trace", exception.what());
    return 1;
  }
}

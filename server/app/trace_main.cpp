// SPDX-License-Identifier: Apache-2.0
// farfield-trace: see trace_tool.h.
#include <exception>
#include <iostream>

#include "server/app/trace_tool.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::run_trace_tool(argument_count, arguments);
  } catch (const std::exception& exception) {
    std::cerr << "farfield-trace: " << exception.what() << '\n';
    return 1;
  }
}

// SPDX-License-Identifier: Apache-2.0
// farfield-scene: see scene_tool.h.
#include <exception>
#include <iostream>

#include "common/base/one_line.h"
#include "server/app/scene_tool.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::run_scene_tool(argument_count, arguments);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-scene", exception.what());
    return 1;
  }
}

// SPDX-License-Identifier: Apache-2.0
// farfield-bench: methods of showing a scene, side by side on one trace.
#include <exception>
#include <iostream>

#include "common/base/one_line.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/client_role.h"

int main(int argc, char** argv) {
  try {
    const auto command = farfield::bench::parse_command(argc, argv);
    if (!command) return command.error();
    if (command->is_client) return farfield::bench::run_client_role(command->client);
    const farfield::Status status = farfield::bench::run_bench(command->bench);
    if (status) return 0;
    farfield::complain(std::cerr, "farfield-bench", status.error().message);
    return status.error().code == farfield::ErrorCode::kInvalidArgument ? 2 : 1;
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-bench", exception.what());
    return 1;
  }
}

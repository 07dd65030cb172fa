// SPDX-License-Identifier: Apache-2.0
// farfield-bench: methods of showing a scene, side by side on one trace.
#include <algorithm>
#include <fstream>
#include <iostream>

#include "tests/bench/bench_program.h"
#include "tests/bench/client_role.h"

int main(int argc, char** argv) {
  const auto command = farfield::bench::parse_command(argc, argv);
  if (!command) return command.error();
  if (command->is_client) return farfield::bench::run_client_role(command->client);
  const farfield::Status status = farfield::bench::run_bench(command->bench);
  if (status) return 0;
  std::cerr << "farfield-bench: " << status.error().message << '\n';
  return 1;
}

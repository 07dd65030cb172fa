// SPDX-License-Identifier: Apache-2.0
// farfield-client: see client_program.h.
#include <exception>
#include <iostream>

#include "client/app/client_program.h"

int main(int argument_count, char** arguments) {
  try {
    return farfield::client::run_client(argument_count, arguments, std::cout, std::cerr);
  } catch (const std::exception& exception) {
    std::cerr << "farfield-client: " << exception.what() << '\n';
    return farfield::client::kExitFailure;
  }
}

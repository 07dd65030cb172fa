// SPDX-License-Identifier: Apache-2.0
// farfield-client: see client_program.h.
#include <exception>
#include <iostream>

#include "client/app/client_program.h"
#include "common/base/one_line.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

int main(int argument_count, char** arguments) {
#ifdef M_ARENA_MAX
  // By default the C library keeps up to eight heaps per processor, each with freed blocks of its own.
  mallopt(M_ARENA_MAX, 2);
#endif
  try {
    return farfield::client::run_client(argument_count, arguments, std::cout, std::cerr);
  } catch (const std::exception& exception) {
    farfield::complain(std::cerr, "farfield-client", exception.what());
    return farfield::client::kExitFailure;
  }
}

// SPDX-License-Identifier: Apache-2.0
// farfield-import: reads one model file at arm's length, so that a file that crashes its reader harms nobody else.
#include "server/model/import_file.h"

int main(int argument_count, char** arguments) {
  return farfield::run_import_program(argument_count, arguments);
}

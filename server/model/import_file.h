// SPDX-License-Identifier: Apache-2.0
// What the import process does: one file to a model in file axes, by the reader its format needs.
#pragma once

#include <cstdint>
#include <filesystem>

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

struct ImportLimits {
  std::uint64_t memory_bytes = std::uint64_t{8} << 30;  // address space of the process, and size of what it hands over
  std::uint64_t cpu_seconds = 600;
};

/// Limits the calling process for good, lets the kernel end it with its parent, and switches core dumps off.
Status limit_import_process(const ImportLimits& limits);

/// Errors: kNotFound, kBadData, kLimitExceeded, kIo. May crash or be killed: that is what the process is for.
Result<Model> import_file(const std::filesystem::path& path);

/// All of the import program behind its command line: `FILE OUTPUT_DESCRIPTOR MEMORY_BYTES CPU_SECONDS`.
/// Returns: 0 with the model stream written to the descriptor, 1 with one line on stderr, 2 for wrong arguments.
int run_import_program(int argument_count, char** arguments);

}  // namespace farfield

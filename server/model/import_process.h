// SPDX-License-Identifier: Apache-2.0
// The parent's side of an import: starts farfield-import, waits for it within limits, and takes over what it made.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

struct ImportProcessOptions {
  std::filesystem::path program;  // farfield-import; empty: beside the running program
  std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30;
  std::chrono::seconds time_limit{600};  // processor time; the wall clock gets twice as much
};

/// Returns: what import_file() made of `path`, checked but not yet cleaned. A crash, a time-out, or too little memory
/// in the import process is one clear error line; this process is safe from all of them. Blocks; thread-safe.
/// Errors: kNotFound, kBadData, kLimitExceeded, kIo, kInternal.
Result<Model> import_in_process(const std::filesystem::path& path, const ImportProcessOptions& options);

}  // namespace farfield

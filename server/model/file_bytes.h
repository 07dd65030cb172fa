// SPDX-License-Identifier: Apache-2.0
// A whole file in memory, read once.
#pragma once

#include <filesystem>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace farfield {

/// Errors: kNotFound (no such file), kBadData (a directory, an empty file), kIo.
Result<Bytes> read_file_bytes(const std::filesystem::path& path);

/// The first `count` bytes of a file, fewer if it is shorter. Errors: as above.
Result<Bytes> read_file_start(const std::filesystem::path& path, std::size_t count);

}  // namespace farfield

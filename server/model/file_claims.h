// SPDX-License-Identifier: Apache-2.0
// Headers that promise more than their file holds, found before anyone reserves memory for the promise.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "common/base/result.h"
#include "server/model/file_format.h"

namespace farfield {

struct FileClaims {
  std::optional<std::size_t> stored_triangles;  // glTF only: what its index lists add up to
};

/// Compares the counts in the header of a PLY, STL or OFF file, the lengths and accessor counts of a glTF file, and
/// the end mark of an IFC file with what the file holds. Other formats announce nothing.
/// Requires: find_model_format() gave `format` for `path`.
/// Errors: kBadData with what is claimed and what is there, kIo.
Result<FileClaims> check_file_claims(const std::filesystem::path& path, ModelFormat format);

}  // namespace farfield

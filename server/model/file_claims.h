// SPDX-License-Identifier: Apache-2.0
// Headers that promise more than their file holds, found before anyone reserves memory for the promise.
#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "server/model/file_format.h"

namespace farfield {

/// Compares the counts in the header of a PLY, STL or OFF file, and the lengths and accessor counts of a glTF file,
/// with the file's size. Other formats announce nothing. Requires: find_model_format() gave `format` for `path`.
/// Errors: kBadData with what is claimed and what is there, kIo.
Status check_file_claims(const std::filesystem::path& path, ModelFormat format);

}  // namespace farfield

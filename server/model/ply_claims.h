// SPDX-License-Identifier: Apache-2.0
// The PLY part of file_claims.h: what the header promises, and what each list in the data says about its own length.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

/// `start`: the first bytes of the file, with the header; `size`: of the whole file. Errors: kBadData, as
/// read_file_bytes().
Status check_ply_claims(const std::filesystem::path& path, std::string_view start, double size);

}  // namespace farfield

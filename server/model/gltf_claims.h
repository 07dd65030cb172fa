// SPDX-License-Identifier: Apache-2.0
// The glTF half of file_claims.h: container lengths, buffers that exist, accessors that fit into their buffer views.
#pragma once

#include "server/model/file_claims.h"

namespace farfield {

Result<FileClaims> check_gltf_claims(const std::filesystem::path& path, ModelFormat format);

}  // namespace farfield

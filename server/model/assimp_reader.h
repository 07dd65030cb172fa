// SPDX-License-Identifier: Apache-2.0
// Files that Assimp reads (glTF, PLY, STL, OFF, COLLADA, AC3D, IFC). Assimp aborts on some broken files: call this in
// the import process only.
#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "server/model/file_format.h"
#include "server/model/model.h"

namespace farfield {

/// Returns: the model in the file's axes, node transforms composed in double; a mesh that several nodes use stays one
/// mesh with several instances. Lines and points are dropped with a warning. It may hold no triangle.
/// Errors: kBadData with Assimp's reason.
Result<Model> read_with_assimp(const std::filesystem::path& path, ModelFormat format);

}  // namespace farfield

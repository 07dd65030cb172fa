// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ with MTL, read in double so that georeferenced coordinates lose nothing.
//
// Polygons may be concave; indices may be negative; vertices may carry colours ("v x y z r g b"). Lines and points
// are dropped and counted. One mesh per run of object/group and material.
#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

/// Returns: the model in file units and axes, with warnings; it may hold no triangle, and unusable positions as NaN.
/// Errors: kNotFound, kBadData (a folder, an empty file), kIo.
Result<Model> read_obj(const std::filesystem::path& path);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// A model as a binary glTF 2.0 file that other programs (and load_model()) read.
#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

/// Meshes are stored once and placed by one node per instance: a translation where that is all, else a matrix, as
/// decimal numbers with all the digits of a double. Colours become linear factors and 16-bit linear vertex colours;
/// textures are embedded as PNG. Written under a temporary name in the same folder and renamed when complete and on
/// disk, so no partial file is left behind under `path`, and none at all after an error. Streams: little memory
/// beyond the model's own.
/// Errors: kIo (with the reason), kLimitExceeded (beyond the 4 GB a GLB can hold), kInvalidArgument (no triangles).
Status write_glb(const Model& model, const std::filesystem::path& path);

}  // namespace farfield

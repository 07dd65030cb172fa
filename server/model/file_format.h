// SPDX-License-Identifier: Apache-2.0
// Which reader a model file needs, told by its extension and first bytes, and whether its header can be true.
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"

namespace farfield {

enum class ModelFormat { kObj, kCityJson, kGlb, kGltf, kPly, kStl, kOff, kCollada, kAc3d, kIfc };

/// Errors: kNotFound, kBadData (a folder, an empty file, an extension nobody reads, a compressed file, content that
/// is not what the extension says), kIo.
Result<ModelFormat> find_model_format(const std::filesystem::path& path);

/// "glTF (binary)", "PLY", …
const char* model_format_name(ModelFormat format);
/// The axis that points up where nothing else is said: "z" for CityJSON, "y" otherwise.
const char* default_up_axis(ModelFormat format);

}  // namespace farfield

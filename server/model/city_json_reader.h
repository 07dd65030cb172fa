// SPDX-License-Identifier: Apache-2.0
// CityJSON 1.0 to 2.0 and CityJSON text sequences (one feature per line), in double.
//
// MultiSurface, CompositeSurface, Solid, MultiSolid and CompositeSolid, with holes; of every object the geometry with
// the highest level of detail, and nothing of a building whose parts have more detail. Colours stand for semantic
// surface types and object types; textures and geometry templates are left out with a warning.
// Source: OGC 20-072r5, "CityJSON Community Standard 2.0".
#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

/// Returns: the model in file units, Z up. Errors: kNotFound, kBadData (not CityJSON, with the reason), kIo.
Result<Model> read_city_json(const std::filesystem::path& path);

}  // namespace farfield

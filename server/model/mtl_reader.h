// SPDX-License-Identifier: Apache-2.0
// Wavefront MTL: the material library beside an OBJ file. Colours are taken as sRGB, as modelling programs show them.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "server/model/texture_cache.h"

namespace farfield {

/// Appends the materials of the text to `model`, remembering their places in `index_by_name`. A name defined twice
/// keeps its first meaning. Never fails: what is not understood is skipped.
void read_mtl(std::string_view text, Model& model, TextureCache& textures, std::map<std::string, int>& index_by_name);

}  // namespace farfield

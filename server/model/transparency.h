// SPDX-License-Identifier: Apache-2.0
// See-through materials, until there is real transparency: opaque from alpha 0.5 (or the file's cut-off), absent below.
#pragma once

#include "server/model/model.h"

namespace farfield {

/// Readers say "alpha counts" by is_alpha_masked and give the constant part of alpha in base_colour.a. Afterwards
/// every base_colour.a is 255, a material is alpha-masked only if its texture has holes, with the constant alpha
/// moved into the cut-off, and triangles that are absent throughout are gone, counted in one warning. A vertex
/// colour's alpha counts where there is no texture, as the mean over the triangle.
void settle_transparency(Model& model);

}  // namespace farfield

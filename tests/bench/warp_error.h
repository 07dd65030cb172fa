// SPDX-License-Identifier: Apache-2.0
// The warp error (design.md section 9): how far on the screen a sample's decoded position is from the exact hit of its
// own view ray.
#pragma once

#include "server/encode/tile_maker.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// Makes a share of the tiles that each of some sampled poses sees, anew and exactly, decodes what the codec makes of
/// them, and collects the distances of samples inside the frame. `as_meshes`: after merging into depth meshes, with the error that adds.
/// Returns: the 99th percentile in pixels, NaN if nothing is an impostor.
double warp_error_p99(const World& world, const ImpostorSources& sources, const ImpostorSettings& settings, bool as_meshes);

}  // namespace farfield::bench

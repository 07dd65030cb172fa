// SPDX-License-Identifier: Apache-2.0
// The warp error (design.md section 9): how far on the screen a sample's decoded position is from the exact hit of its
// own view ray.
#pragma once

#include <map>

#include "server/encode/tile_maker.h"
#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// Makes a share of the tiles that each of some sampled poses sees, anew and exactly, decodes what the codec makes of
/// them, and collects the distances of samples inside the frame. `as_meshes`: after merging into depth meshes, with the error that adds.
struct WarpErrors {
  double p99 = kNone;               // pixels, over all frames; NaN if nothing is an impostor
  std::map<std::size_t, double> frame_p99;  // of the poses looked at, by their index
};
WarpErrors warp_errors(const World& world, const ImpostorSources& sources, const ImpostorSettings& settings, bool as_meshes);

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
// The user's alternatives to impostors: the full model ray-cast (rays), drawn as it is (geometry; Chuang 2002's
// configuration A), and drawn with frustum culling by chunk (geometry-culled; his B).
#pragma once

#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

Result<MethodResult> run_rays(const World& world);
/// Both geometry methods share one upload. Errors: no OpenGL.
Result<std::vector<MethodResult>> run_geometry(const World& world, bool wants_full, bool wants_culled);

}  // namespace farfield::bench

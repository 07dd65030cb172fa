// SPDX-License-Identifier: Apache-2.0
// The full model as static levels of detail: the usual way of drawing what is too big to draw.
#pragma once

#include "tests/bench/method.h"

namespace farfield::bench {

/// Per frame: whole trees outside the view are left out, and of the rest the coarsest nodes are drawn whose error stays
/// below `error_px` at the nearest point of their bounds (lod_forest.h). Everything is uploaded beforehand: no streaming.
/// Knobs: error_px, samples per pixel. Errors: no OpenGL.
Method geometry_lod_method();

}  // namespace farfield::bench

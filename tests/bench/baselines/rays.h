// SPDX-License-Identifier: Apache-2.0
// The full model ray-cast anew in every frame, nothing streamed.
#pragma once

#include "tests/bench/method.h"

namespace farfield::bench {

/// Knob: samples per pixel.
Method rays_method();

}  // namespace farfield::bench

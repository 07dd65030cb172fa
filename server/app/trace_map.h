// SPDX-License-Identifier: Apache-2.0
// Draws a trace from above: as text for a terminal, as SVG or as pixels. With a scene, what stands in the way at body height.
#pragma once

#include <string>

#include "common/image/image.h"
#include "common/trace/trace.h"
#include "server/scene/scene.h"

namespace farfield {

/// `#` something at body height, `.` free, `o` the path, `S` its start, `E` its end; +X to the right, -Z upwards.
/// `scene` may be null. At most `columns` wide, lines end in '\n'. Requires: a trace with frames.
std::string text_map(const Trace& trace, const Scene* scene, int columns = 78);

/// A drawing about 900 px wide: the plan, the path, the direction of sight along it and a scale.
std::string svg_map(const Trace& trace, const Scene* scene);

/// The same drawing in pixels, RGB.
Image8 png_map(const Trace& trace, const Scene* scene);

}  // namespace farfield

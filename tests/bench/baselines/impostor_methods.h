// SPDX-License-Identifier: Apache-2.0
// The impostors of others, on Farfield's cells: billboard, tdm, ldi-9 and itdm. What each does and where it differs from its
// paper stands in simple_impostors.h, layered_image.h, layer_painter.h and itdm.h.
//
// What is the same for all four, and for Farfield: cells are the leaves of the scene's cell tree; what lies in a leaf's near
// region is drawn from chunks, exactly, and costs the same bytes; samples are cast and shaded by the same functions; cracks of
// one pixel are closed and voids filled as in Farfield's client; colours are JPEG of the same quality. What the papers do not have, they
// do not get here: one impostor stands for everything beyond a leaf's near region, to infinity (no nested shells), all
// of it is made and sent (no test of what the leaf can see), and cells are not shared by levels.
//
// Bytes: each leaf the trace enters costs its impostor and the chunks and textures not needed before. Impostors are made
// for the first leaf and for those of the frames that are compared; the others count as the mean of these.
#pragma once

#include "tests/bench/method.h"

namespace farfield::bench {

/// billboard, tdm, ldi-9, itdm; all sample as densely as Farfield unless told otherwise.
std::vector<Method> impostor_methods(const BenchOptions& options);

}  // namespace farfield::bench

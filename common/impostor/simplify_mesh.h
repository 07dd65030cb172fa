// SPDX-License-Identifier: Apache-2.0
// Fewer triangles for the same picture: edges of a depth mesh are collapsed while surfaces and outlines stay where they
// are. Straight silhouettes, which cut cells divide at every sample, become single edges; what bends gently, like the
// flank of a pipe, becomes strips.
//
// Based on: Garland & Heckbert 1997 (quadric error metrics), by meshoptimizer's simplifier. Differs: quadrics bound no
// single sample, so the result is checked against the samples and made again more finely where it misses one.
#pragma once

#include "common/impostor/depth_mesh.h"
#include "common/impostor/patch_mesh.h"
#include "common/impostor/surface_patch.h"

namespace farfield {

/// How far an outline may move, in samples: silhouettes themselves are known to 1/8 of a sample, and stay within that
/// plus this, a third of a pixel where a sample is largest.
inline constexpr float kOutlineSamples = 0.2f;

/// Quadrics average, so single samples miss the tolerance they aim at, by at most this factor. The decoder's tolerance
/// is that of coding, 1/4 pixel of warp at the centre of a frame: with 5/8 pixel from here what is shown there is within 7/8 of
/// a pixel of what was cast, and nearly all within one towards the sides, where a pixel takes less of an angle.
inline constexpr float kWorstOverTolerance = 2.5f;

/// Merges vertices that coincide, then simplifies. Samples of `patch` that lie inside one surface stay covered and
/// within kWorstOverTolerance·`tolerance` of their disparity, most of them within `tolerance`; vertices are a subset of those given, and no new crack opens between triangles.
/// Requires: `mesh` was drawn from `patch` at `place` alone. Cost: O(n log n), some 2 ms for a tile.
void simplify_mesh(const SurfacePatch& patch, const PatchPlace& place, float tolerance, DepthMesh& mesh);

}  // namespace farfield

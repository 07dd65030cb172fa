// SPDX-License-Identifier: Apache-2.0
// Enclosures: the parts of a box's free space that walls cut off from each other. Whoever stands in a closed room needs
// nothing of what only the street outside it sees, though one box of viewpoints holds some of both.
//
// Based on: the cells of cells-and-portals subdivision (Teller and Séquin 1991), found by rays instead of from planes.
#pragma once

#include <vector>

#include "common/impostor/enclosure_mask.h"
#include "server/scene/scene.h"

namespace farfield {

/// The enclosure of each of `viewpoints`, counted from 0: two that see each other, or both see a third, share one.
/// O(viewpoints²) rays.
std::vector<int> join_by_sight(const Scene& scene, const std::vector<glm::dvec3>& viewpoints);

/// Up to this many enclosures are told apart; who stands in another is told what the whole box sees.
inline constexpr int kMaxEnclosures = 4;

/// From so many viewpoints an enclosure is looked at, if it has as many.
inline constexpr std::size_t kEnclosureViewpoints = 8;

struct Enclosures {
  std::vector<glm::dvec3> viewpoints;  // those given, and what was found of enclosures that hold none of them
  std::vector<int> of_viewpoint;       // index into masks, or -1: of a viewpoint that no mask speaks for
  std::vector<EnclosureMask> masks;    // disjoint; empty: the box is not worth dividing
};

/// Divides `box` by what its free `viewpoints` (scene frame, one at least) see of each other, and of an 8×8×8 lattice:
/// free places that no viewpoint sees may lie in a room between them. A point of the box that sees viewpoints of two
/// enclosures makes them one: each voxel of an octree is tried in eight places, and those in which different enclosures
/// meet are divided until their edge is at most `finest_voxel_m` or the mask's depth is used up. There the voxel
/// belongs to nobody. Deterministic. Some 600 packets of rays where there is one enclosure, else one for each place
/// tried.
Enclosures find_enclosures(const Scene& scene, const Box& box, const std::vector<glm::dvec3>& viewpoints,
                           double finest_voxel_m);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// What can be seen from a box of viewpoints: near chunks, the points hit beyond, whether rays escape the scene.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "common/impostor/direction_mask.h"
#include "server/visibility/enclosures.h"
#include "server/visibility/visible_chunks.h"

namespace farfield {

/// A surface point seen from the box but outside its near box, and the share of a viewpoint's sphere its ray stands
/// for.
struct FarHit {
  glm::vec3 point;             // scene frame
  float solid_angle = 0;       // steradians, of one viewpoint's ray
  std::int8_t enclosure = -1;  // of the viewpoint: index into BoxVisibility::enclosures, or none
  glm::vec3 normal{0};         // of any length
};

/// What a set of viewpoints sees.
struct Sight {
  std::vector<std::uint32_t> near_chunks;  // unordered
  std::size_t near_triangles = 0;
  std::size_t viewpoints = 0;
  bool escapes = false;  // some ray leaves the scene: the background is visible …
  DirectionMask sky;     // … in these directions
};

/// Of those viewpoints of a box that share an enclosure.
struct EnclosureVisibility : Sight {
  EnclosureMask mask;
};

struct BoxVisibility : Sight {
  std::vector<FarHit> far_hits;
  bool is_blocked = false;                      // nobody can stand in the box: looked at from its lattice alone
  bool is_converged = true;                     // fresh viewpoints hardly found anything new
  bool is_cut_short = false;                    // stopped: near_triangles passed `enough_triangles`, or cancelled
  std::vector<EnclosureVisibility> enclosures;  // none: all viewpoints share what they see. Of whole, thorough probes
};

struct VisibilityProbe {
  int edge = 80;                                   // rays per face edge and viewpoint, a multiple of 4
  std::size_t enough_triangles = ~std::size_t{0};  // stop once more near triangles than this are known to be visible
  bool is_thorough = true;                         // find thin chunks, and check that fresh viewpoints find nothing new
  double enclosure_voxel_m = 0.25;                 // how closely enclosures follow the walls between them
  const std::atomic<bool>* cancel = nullptr;
};

/// Casts viewpoints·6·edge² rays: from a lattice of up to 27 free viewpoints, then (thorough probes) from batches of
/// nine others until one adds less than a hundredth to the near triangles; not converged after three: the box is too
/// large against what stands in it to be spoken for by samples. Then from 108 more, a quarter of the rays from each; and
/// each enclosure is looked at from kEnclosureViewpoints at least, as far as free ones are found. Directions are
/// jittered by viewpoint with a fixed sequence: deterministic. Thorough probes send three rays more between neighbours that met
/// different surfaces. Far hits are kept only for probes that run to their end.
BoxVisibility probe_visibility(const Scene& scene, const Box& viewpoints, const Box& near_box,
                               const VisibilityProbe& probe);

}  // namespace farfield

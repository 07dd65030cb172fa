// SPDX-License-Identifier: Apache-2.0
// What can be seen from a box of viewpoints: near chunks, the points hit beyond, whether rays escape the scene.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "common/impostor/direction_mask.h"
#include "server/visibility/visible_chunks.h"

namespace farfield {

/// A surface point seen from the box but outside its near box, and the share of a viewpoint's sphere its ray stands for.
struct FarHit {
  glm::vec3 point;         // scene frame
  float solid_angle = 0;   // steradians, of one viewpoint's ray
};

struct BoxVisibility {
  std::vector<std::uint32_t> near_chunks;  // unordered
  std::size_t near_triangles = 0;
  std::vector<FarHit> far_hits;
  std::size_t viewpoints = 0;
  bool escapes = false;                    // some ray leaves the scene: the background is visible …
  DirectionMask sky;                       // … in these directions
  bool is_converged = true;                // fresh viewpoints hardly found anything new
  bool is_cut_short = false;               // stopped: near_triangles passed `enough_triangles`, or cancelled
};

struct VisibilityProbe {
  int edge = 80;                           // rays per face edge and viewpoint, a multiple of 4
  std::size_t enough_triangles = ~std::size_t{0};  // stop once more near triangles than this are known to be visible
  bool is_thorough = true;                 // find thin chunks, and check that fresh viewpoints find nothing new
  const std::atomic<bool>* cancel = nullptr;
};

/// Casts viewpoints·6·edge² rays: from a lattice of up to 27 free viewpoints, then (thorough probes) from batches of
/// nine others until one adds less than a hundredth to the near triangles; not converged after three: the box is too
/// large against what stands in it to be spoken for by samples. Directions are jittered by viewpoint with a fixed sequence:
/// deterministic. Far hits are kept only for probes that run to their end.
BoxVisibility probe_visibility(const Scene& scene, const Box& viewpoints, const Box& near_box, const VisibilityProbe& probe);

}  // namespace farfield

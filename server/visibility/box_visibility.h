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
  bool is_cut_short = false;               // stopped: near_triangles passed `enough_triangles`, or cancelled
};

struct VisibilityProbe {
  int edge = 96;                           // rays per face edge and viewpoint, a multiple of 4
  std::size_t enough_triangles = ~std::size_t{0};  // stop once more near triangles than this are known to be visible
  bool finds_thin_chunks = true;
  const std::atomic<bool>* cancel = nullptr;
};

/// Casts viewpoints·6·edge² rays (viewpoints <= 27). Directions are jittered by viewpoint with a fixed sequence:
/// deterministic. Far hits are kept only for probes that run to their end.
BoxVisibility probe_visibility(const Scene& scene, const Box& viewpoints, const Box& near_box, const VisibilityProbe& probe);

}  // namespace farfield

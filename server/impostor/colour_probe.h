// SPDX-License-Identifier: Apache-2.0
// What a tile is worth beside truth: colours at random places between its samples, and how far its disparities moved in
// coding.
//
// A probe is a pixel of the display at a random place of the tile. Truth is the mean of sixteen rays through it, the tile's
// share of it what a client shows there: the nearest sample, or for four samples per pixel the nearest to each quarter.
// What other shells and the sky show beside the tile's surface counts as shown exactly. Sampling, filtering and coding are
// in the figure; what the warp to another viewpoint adds is not (frame_promise.h allows for it).
#pragma once

#include <vector>

#include "common/impostor/certificate.h"
#include "common/impostor/coded_samples.h"
#include "common/impostor/tile.h"
#include "common/math/camera.h"
#include "server/impostor/view_frame.h"

namespace farfield {

/// Rays of a tile's probes, cast once: they can be held against several encodings of it.
class ColourProbes {
 public:
  /// kProbes packets of rays, fewer than a sixtieth of a full tile's. Deterministic: the places depend on the tile's name and
  /// coverage only. `view`: where the tile's view stands. Requires: the tile as cast.
  ColourProbes(const Scene& scene, const CellSpace& space, const glm::dvec3& view, const Tile& tile, const Display& display);

  /// Sets the tile's half of a certificate. `exact`: the tile as cast; `decoded`: the same as clients will have it.
  void measure(const Tile& exact, const CodedSamples& decoded, Certificate& certificate) const;

  static constexpr int kProbes = 16;  // a frame shows some thirty tiles

 private:
  struct Quarter {
    glm::vec3 beside{0};  // linear: sum over rays that miss the shell's surfaces or see past them
    int rays_beside = 0;
    int sample = -1;      // nearest to its centre; -1: none that the tile holds
  };
  struct Probe {
    std::uint8_t truth[3];
    int sample;  // nearest to its centre
    Quarter quarters[4];
  };
  std::vector<Probe> probes_;
};

}  // namespace farfield

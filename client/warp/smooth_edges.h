// SPDX-License-Identifier: Apache-2.0
// Smooths the staircases along silhouettes of a frame drawn with one sample per pixel, by what a pixel's neighbours tell of
// where the silhouette ran.
//
// Based on: Reshetov 2009, Morphological Antialiasing, section 2 (steps of Z, U and L shape; the area that the line through
// their middles cuts off a pixel). Differs: only where disparity jumps, so that textures stay as they are.
#pragma once

#include <cstdint>
#include <vector>

#include "client/warp/frame_image.h"

namespace farfield::client {

class EdgeSmoother {
 public:
  /// Changes colours of `frame`, nothing else. Runs on the calling TBB arena's threads; the result does not depend on their
  /// number. Linear in pixels. One call at a time: keeps its buffers, a byte per pixel and 12 per pixel changed.
  void smooth(Frame& frame);

 private:
  struct Blend {
    std::uint32_t pixel;
    std::uint32_t colour;  // of the neighbour, 0xAABBGGRR
    float share;           // of it
  };
  struct Band {
    int first_row, last_row;
    std::vector<Blend> blends;
  };
  class Steps;

  std::vector<std::uint8_t> edges_;  // per pixel
  std::vector<Band> bands_;
};

}  // namespace farfield::client

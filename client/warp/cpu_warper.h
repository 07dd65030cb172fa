// SPDX-License-Identifier: Apache-2.0
// Draws impostors on the CPU: splats of all tiles, scattered into a depth-and-colour buffer that near geometry was drawn
// into. For machines without a GPU, where it is several times faster than OpenGL.
//
// A frame: cull tiles and find the rows they reach -> per band of rows, in parallel: draw near geometry, cull squares of
// samples, project and scatter -> close cracks -> fill voids -> smooth edges, or average 2×2 samples. Bands fit in a core's
// cache and share nothing, so the result does not depend on the number of threads.
//
// Based on: McMillan & Bishop 1995; Shade et al. 1998 (splatting layered depth images).
#pragma once

#include <memory>

#include "client/store/leaf_view.h"
#include "client/warp/frame_image.h"
#include "client/warp/near_rows.h"
#include "client/warp/scatter.h"
#include "common/math/camera.h"

namespace farfield::client {

struct CpuWarperOptions {
  int samples_per_pixel = 1;  // 1, or 4: 2×2, averaged in linear light; four times the pixels, the same samples
  int threads = 0;            // 0: one per core; threads are kept from frame to frame
  ProjectionKernel kernel = ProjectionKernel::kVector;
  bool smooth_edges = true;  // smooth_edges.h; of frames with 1 sample per pixel
};

class CpuWarper {
 public:
  explicit CpuWarper(const CpuWarperOptions& options = {});
  ~CpuWarper();

  /// Draws `leaf` as seen from `eye` (scene frame). `near`: what lies before it, or null. `frame` is overwritten; reusing it
  /// saves allocations. One call at a time. Requires: the display has at least one pixel.
  void draw(const LeafView& leaf, const Pose& eye, const Display& display, const NearRows* near, Frame& frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield::client

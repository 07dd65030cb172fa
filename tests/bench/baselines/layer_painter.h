// SPDX-License-Identifier: Apache-2.0
// Warps layered depth images to a frame on the CPU.
//
// Based on: Aliaga 1998, section 4.2: McMillan and Bishop's warp, drawn in their occlusion-compatible order, without a depth
// buffer, as splats of a fixed 3×3 pixels. Differs: the six images of a cell share a centre and are drawn so that what
// lies nearer to the eye's direction comes later; squares of 32×32 pixels that cannot be on the screen are left out; all
// cores are used by bands of the frame, which keep the order, where he gave each core a sheet. Each splat writes its disparity as
// well, so that holes can be filled as Farfield's client fills them.
#pragma once

#include "client/warp/frame_image.h"
#include "common/math/camera.h"
#include "tests/bench/baselines/layered_image.h"

namespace farfield::bench {

struct PaintOptions {
  int splat_radius = 1;           // 1: 3×3 pixels
  bool has_depth_buffer = false;  // for tests: the nearest splat wins, whatever the order
};

class LayerPainter {
 public:
  explicit LayerPainter(const PaintOptions& options = {}) : options_(options) {}

  /// Finds the bounds of the squares. `cell` must outlive this or the next call.
  void set_cell(const LayeredCell& cell);

  /// Draws over `frame`, sized already and of class kBackground where nothing is yet. Pixels of class kNear stay: near
  /// geometry lies in a convex region around the eye that holds no sample. Returns: samples warped.
  std::size_t paint(const Pose& eye, const Display& display, client::Frame& frame);

 private:
  struct Square {
    int face = 0, i0 = 0, i1 = 0, j0 = 0, j1 = 0;  // half-open
    float low = 0, high = 0;                       // disparities
  };
  struct Run {  // of pixels of one face, drawn with i and j each rising or falling
    int face = 0, i0 = 0, i1 = 0, j0 = 0, j1 = 0;
    bool is_i_rising = true, is_j_rising = true;
  };
  struct Splat {
    std::int16_t x = 0, y = 0;
    std::uint32_t colour = 0;  // 0x00BBGGRR
    float disparity = 0;       // 1/m along the camera's axis
  };
  using Band = std::vector<Splat>;

  std::vector<Run> ordered_runs(const Pose& eye, const Display& display) const;
  std::size_t warp(const Run& run, const Pose& eye, const Display& display, int band_rows, std::vector<Band>& bands) const;
  void draw(const Band& band, int first_row, int last_row, client::Frame& frame) const;

  PaintOptions options_;
  const LayeredCell* cell_ = nullptr;
  std::vector<Square> squares_;
  std::vector<std::vector<Band>> chunks_;  // kept for their memory
};

}  // namespace farfield::bench

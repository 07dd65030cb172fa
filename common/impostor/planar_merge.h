// SPDX-License-Identifier: Apache-2.0
// Finds the rectangles of plain quads whose disparity is a plane within a tolerance.
//
// Midpoint recursion (a quadtree over any rectangle). A rectangle is kept whole if every sample in it lies within
// half the tolerance of the least-squares plane of its disparities: whatever samples on its border later become
// vertices, each triangle's surface is then within half the tolerance of that plane too, and within the tolerance of
// every sample. Sums over rectangles come from summed-area tables, so planes cost O(1) and checking O(samples).
//
// Based on: Crow 1984 (summed-area tables); quadtree meshing as in Lindstrom et al. 1996.
#pragma once

#include <cstdint>
#include <vector>

#include "common/impostor/surface_patch.h"

namespace farfield {

/// Quads [x0, x1) × [y0, y1); its corners are samples (x0, y0) … (x1, y1).
struct QuadRect {
  std::int16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int quads() const { return (x1 - x0) * (y1 - y0); }
};

/// disparity(x, y) = constant + slope_x·x + slope_y·y in samples of the patch.
struct DisparityPlane {
  double constant = 0, slope_x = 0, slope_y = 0;
  double at(double x, double y) const { return constant + slope_x * x + slope_y * y; }
};

/// Keeps its tables between patches. One thread at a time.
class PlanarMerge {
 public:
  /// `patch` and `kinds` must outlive the calls below. With tolerance 0 (or less) nothing is merged.
  void prepare(const SurfacePatch& patch, const std::vector<QuadKind>& kinds, float tolerance);
  /// Appends the rectangles that make up `root`: plain ones merged, all others of one quad each, kNone left out.
  void divide(const QuadRect& root, std::vector<QuadRect>& out) const;
  /// The least-squares plane over the samples of a rectangle. Requires: prepared with a tolerance above 0.
  DisparityPlane plane(const QuadRect& rect) const;

 private:
  struct Sums {
    double d = 0, xd = 0, yd = 0;
  };
  bool is_plain(const QuadRect& rect) const;
  bool is_planar(const QuadRect& rect) const;

  SurfacePatch patch_;
  const std::vector<QuadKind>* kinds_ = nullptr;
  float tolerance_ = 0;
  std::vector<std::uint32_t> plain_;  // summed-area table of plain quads, width × height
  std::vector<Sums> sums_;            // of disparity and its moments, (width+1) × (height+1)
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// LDR-FLIP: the difference a viewer sees when alternating between two images, 0 … 1 per pixel.
//
// Based on: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images", 2020, sections 4.1 (colour) and 4.2 (features). Differs: all filters are applied as separable
// ones (each is a sum of at most two products of one-dimensional kernels), which changes rounding only.
#pragma once

#include "common/image/image.h"

namespace farfield {

/// A 0.69 m wide 3840-pixel monitor at 0.7 m: the paper's default.
inline constexpr double kFlipPixelsPerDegree = 67.0;

struct FlipResult {
  double mean = 0;
  ImageF error;  // one channel, 0 … 1
};

/// Requires: same size, not empty, at least 3 channels each. Below a second for 1280×720 on one thread.
FlipResult flip(const Image8& reference, const Image8& test, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Structural similarity on luma.
//
// Based on: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to structural
// similarity", 2004, equations 12 to 17: 11×11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03, L = 255, mean over
// the windows that lie wholly inside. Differs: luma keeps its fraction instead of being rounded to 8 bits.
#pragma once

#include "common/image/image.h"

namespace farfield {

inline constexpr int kSsimWindow = 11;

/// Mean SSIM, at most 1. Requires: same size, both edges at least kSsimWindow, at least 3 channels each.
double ssim(const Image8& a, const Image8& b);

}  // namespace farfield

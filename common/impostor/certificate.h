// SPDX-License-Identifier: Apache-2.0
// What an impostor was measured to be worth, with rays that were not used for making it. It travels in the tiles' headers;
// the two halves have different subjects: voids are counted over the whole shell, and every tile of it says the same.
//
// Counts and standard errors are kept, not bounds: tiles are combined first and bounded then (frame_promise.h), which is
// sharper than adding up bounds.
#pragma once

#include <cstdint>

namespace farfield {

struct Certificate {
  // ── the shell ──
  std::uint16_t void_rays = 0;        // directions looked into from validation viewpoints; 0: not measured
  std::uint16_t void_hits = 0;        // of these: the first surface lies in this shell, and no view of it holds it
  std::uint16_t void_worst_hits = 0;  // the same from the worst viewpoint …
  std::uint16_t void_worst_rays = 0;  // … of as many directions

  // ── the tile, but for those of fallback views, which promise nothing ──
  /// Squared difference of 8-bit sRGB values between what is shown at a random place of the tile and truth in a pixel there,
  /// mean over the three channels and over the probes. [0]: shown with one sample per pixel, [1]: with four. -1: not
  /// measured.
  float colour_mse[2] = {-1, -1};
  float colour_mse_error[2] = {-1, -1};  // standard error of that mean
  float disparity_p99 = -1;              // of |decoded - exact| over the tile's samples, 1/side; -1: not measured

  // ── targets that could not be met within the budgets (CertificateTargets) ──
  bool missed_void = false, missed_colour = false;

  bool operator==(const Certificate&) const = default;
  double void_share() const { return void_rays ? static_cast<double>(void_hits) / void_rays : -1; }
  double void_worst_share() const { return void_worst_rays ? static_cast<double>(void_worst_hits) / void_worst_rays : -1; }
};

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Compares frames with truth.
#pragma once

#include <functional>

#include "server/scene/reference_image.h"
#include "tests/bench/frame_dump.h"
#include "tests/bench/method_result.h"

namespace farfield::bench {

/// What is compared: colours, and which pixels show nothing.
struct JudgedFrame {
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint8_t> is_uncovered;  // before filling beyond one-pixel cracks; empty: the method has no voids
};
JudgedFrame judged(const client::Frame& frame);

class ErrorAverage {
 public:
  explicit ErrorAverage(const Display& display) : display_(display) {}
  /// `is_far`: the pixels that impostors stand for (ViewerCells::far_pixels); empty: not asked for.
  void add(const JudgedFrame& frame, const ReferenceImage& truth, const std::vector<std::uint8_t>& is_far);
  ErrorFigures figures() const;
  /// Of the frame added last; NaN where it has none.
  double last_void_share() const { return last_void_share_; }
  double last_impostor_psnr() const { return last_impostor_psnr_; }

 private:
  const Display display_;
  double last_void_share_ = kNone, last_impostor_psnr_ = kNone;
  std::vector<double> psnr_, impostor_psnr_, ssim_, flip_, void_share_;
};

}  // namespace farfield::bench

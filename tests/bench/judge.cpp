// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/judge.h"

#include <algorithm>

#include "common/image/flip.h"
#include "common/image/psnr.h"
#include "common/image/ssim.h"
#include "tests/bench/distribution.h"

namespace farfield::bench {
namespace {

Image8 as_image(const std::vector<std::uint8_t>& rgb, int width, int height) {
  Image8 image(width, height, 3);
  image.values = rgb;
  return image;
}

}  // namespace

JudgedFrame judged(const client::Frame& frame) {
  JudgedFrame result;
  result.rgb.resize(3 * frame.pixels());
  result.is_uncovered.resize(frame.pixels());
  for (std::size_t i = 0; i < frame.pixels(); ++i) {
    for (int c = 0; c < 3; ++c) result.rgb[3 * i + c] = frame.rgba[4 * i + c];
    const client::Coverage coverage = frame.coverage[i];
    result.is_uncovered[i] = coverage == client::Coverage::kVoidFilled || coverage == client::Coverage::kBackground;
  }
  return result;
}

void ErrorAverage::add(const JudgedFrame& frame, const ReferenceImage& truth, const std::vector<std::uint8_t>& is_far) {
  const Image8 seen = as_image(frame.rgb, truth.width, truth.height), wanted = as_image(truth.rgb, truth.width, truth.height);
  psnr_.push_back(psnr_db(wanted, seen));
  ssim_.push_back(ssim(wanted, seen));
  // FLIP is defined per pixels per degree: 67, whatever the field of view of the frame.
  flip_.push_back(flip(wanted, seen).mean);
  last_void_share_ = last_impostor_psnr_ = kNone;
  if (std::find(is_far.begin(), is_far.end(), 1) != is_far.end()) {
    last_impostor_psnr_ = psnr_db(wanted, seen, is_far);
    impostor_psnr_.push_back(last_impostor_psnr_);
  }
  if (frame.is_uncovered.empty()) return;
  std::size_t voids = 0;
  for (std::size_t i = 0; i < frame.is_uncovered.size(); ++i) voids += frame.is_uncovered[i] && truth.has_surface[i];
  last_void_share_ = static_cast<double>(voids) / static_cast<double>(frame.is_uncovered.size());
  void_share_.push_back(last_void_share_);
}

ErrorFigures ErrorAverage::figures() const {
  ErrorFigures f;
  f.psnr_mean = mean(psnr_), f.psnr_min = smallest(psnr_);
  f.impostor_psnr_mean = mean(impostor_psnr_), f.impostor_psnr_min = smallest(impostor_psnr_);
  f.ssim_mean = mean(ssim_), f.ssim_min = smallest(ssim_);
  f.flip_mean = mean(flip_), f.flip_max = largest(flip_);
  f.void_mean = mean(void_share_), f.void_max = largest(void_share_);
  return f;
}

}  // namespace farfield::bench

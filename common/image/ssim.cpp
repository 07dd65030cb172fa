// SPDX-License-Identifier: Apache-2.0
#include "common/image/ssim.h"

#include <array>
#include <cassert>
#include <cmath>

#include "common/image/convolve.h"

namespace farfield {
namespace {

constexpr int kRadius = kSsimWindow / 2;
constexpr double kSigma = 1.5;
constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
constexpr double kC2 = (0.03 * 255) * (0.03 * 255);

std::array<float, kSsimWindow> gaussian_window() {
  std::array<float, kSsimWindow> window;
  double sum = 0;
  const auto value = [](int i) { return std::exp(-(i - kRadius) * (i - kRadius) / (2 * kSigma * kSigma)); };
  for (int i = 0; i < kSsimWindow; ++i) sum += value(i);
  for (int i = 0; i < kSsimWindow; ++i) window[i] = static_cast<float>(value(i) / sum);
  return window;
}

/// Rec. 601 luma, less 128: variances are differences of means of squares, which smaller numbers keep exact.
ImageF centred_luma(const Image8& image) {
  ImageF luma(image.width, image.height, 1);
  const std::uint8_t* p = image.values.data();
  for (float& value : luma.values) {
    value = 0.299f * p[0] + 0.587f * p[1] + 0.114f * p[2] - 128.0f;
    p += image.channels;
  }
  return luma;
}

ImageF windowed_mean_of_product(const ImageF& a, const ImageF& b, const std::array<float, kSsimWindow>& window) {
  ImageF product(a.width, a.height, 1);
  for (std::size_t i = 0; i < product.values.size(); ++i) product.values[i] = a.values[i] * b.values[i];
  return convolve_columns(convolve_rows(product, window), window);
}

}  // namespace

double ssim(const Image8& image_a, const Image8& image_b) {
  assert(image_a.same_size(image_b) && image_a.channels >= 3 && image_b.channels >= 3);
  assert(image_a.width >= kSsimWindow && image_a.height >= kSsimWindow);
  const auto window = gaussian_window();
  const ImageF a = centred_luma(image_a), b = centred_luma(image_b);
  const ImageF mean_a = convolve_columns(convolve_rows(a, window), window);
  const ImageF mean_b = convolve_columns(convolve_rows(b, window), window);
  const ImageF aa = windowed_mean_of_product(a, a, window), bb = windowed_mean_of_product(b, b, window),
               ab = windowed_mean_of_product(a, b, window);
  double sum = 0;
  for (int y = kRadius; y < a.height - kRadius; ++y) {
    for (int x = kRadius; x < a.width - kRadius; ++x) {
      const double shifted_a = *mean_a.at(x, y), shifted_b = *mean_b.at(x, y);
      const double variance_a = *aa.at(x, y) - shifted_a * shifted_a;
      const double variance_b = *bb.at(x, y) - shifted_b * shifted_b;
      const double covariance = *ab.at(x, y) - shifted_a * shifted_b;
      const double mu_a = shifted_a + 128, mu_b = shifted_b + 128;
      sum += (2 * mu_a * mu_b + kC1) * (2 * covariance + kC2) /  // equation 13
             ((mu_a * mu_a + mu_b * mu_b + kC1) * (variance_a + variance_b + kC2));
    }
  }
  return sum / (static_cast<double>(a.width - 2 * kRadius) * (a.height - 2 * kRadius));
}

}  // namespace farfield

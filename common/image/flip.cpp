// SPDX-License-Identifier: Apache-2.0
#include "common/image/flip.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "common/image/convolve.h"
#include "common/image/flip_colour.h"

namespace farfield {
namespace {

constexpr double kPi = std::numbers::pi;
// The paper's constants: exponents of colour and feature differences, the knee of the colour curve, and the width of
// the feature filters in degrees.
constexpr float kColourExponent = 0.7f, kKneeAt = 0.4f, kKneeValue = 0.95f, kFeatureExponent = 0.5f;
constexpr double kFeatureWidth = 0.082;

using Kernel = std::vector<float>;

/// One Gaussian of a contrast sensitivity function (table 1): amplitude a and width b, in degrees.
struct SensitivityTerm {
  double a, b;
};
constexpr SensitivityTerm kLuminance{1.0, 0.0047}, kRedGreen{1.0, 0.0053}, kBlueYellow1{34.1, 0.04},
    kBlueYellow2{13.5, 0.025};

/// All spatial filters have the support of the widest of them.
int spatial_radius(double ppd) { return static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * kPi * kPi)) * ppd)); }

/// exp(-π²·x²/b), unnormalised, and its sum.
Kernel spatial_kernel(double b, double ppd, double& sum) {
  const int radius = spatial_radius(ppd);
  Kernel kernel;
  sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    const double x = i / ppd, value = std::exp(-kPi * kPi * x * x / b);
    kernel.push_back(static_cast<float>(value));
    sum += value;
  }
  return kernel;
}

ImageF convolve(const ImageF& in, const Kernel& rows, const Kernel& columns) {
  return convolve_columns(convolve_rows(in, rows), columns);
}

/// `share`: what the filtered image is multiplied by in all.
ImageF filter_term(const ImageF& in, const SensitivityTerm& term, double ppd, double share) {
  double sum = 0;
  Kernel kernel = spatial_kernel(term.b, ppd, sum);
  for (float& k : kernel) k = static_cast<float>(k * std::sqrt(share) / sum);
  return convolve(in, kernel, kernel);
}

ImageF filter_blue_yellow(const ImageF& in, double ppd) {
  double sum1 = 0, sum2 = 0;
  spatial_kernel(kBlueYellow1.b, ppd, sum1);
  spatial_kernel(kBlueYellow2.b, ppd, sum2);
  const double weight1 = kBlueYellow1.a * std::sqrt(kPi / kBlueYellow1.b) * sum1 * sum1;
  const double weight2 = kBlueYellow2.a * std::sqrt(kPi / kBlueYellow2.b) * sum2 * sum2;
  ImageF out = filter_term(in, kBlueYellow1, ppd, weight1 / (weight1 + weight2));
  const ImageF second = filter_term(in, kBlueYellow2, ppd, weight2 / (weight1 + weight2));
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] += second.values[i];
  return out;
}

struct Planes {
  ImageF y, cx, cz;
};

Planes opponent_planes(const Image8& image) {
  Planes planes{ImageF(image.width, image.height, 1), ImageF(image.width, image.height, 1),
                ImageF(image.width, image.height, 1)};
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const Colour3 c = ycxcz_from_linear_rgb(linear_rgb_from_srgb(&image.values[i * image.channels]));
    planes.y.values[i] = c[0], planes.cx.values[i] = c[1], planes.cz.values[i] = c[2];
  }
  return planes;
}

/// What the eye resolves of an image, in Hunt-adjusted L*a*b* (section 4.1.1 and 4.1.2).
Planes perceived_planes(const Planes& planes, double ppd) {
  Planes seen{filter_term(planes.y, kLuminance, ppd, 1), filter_term(planes.cx, kRedGreen, ppd, 1),
              filter_blue_yellow(planes.cz, ppd)};
  for (std::size_t i = 0; i < seen.y.values.size(); ++i) {
    Colour3 rgb = linear_rgb_from_ycxcz({seen.y.values[i], seen.cx.values[i], seen.cz.values[i]});
    for (float& channel : rgb) channel = std::clamp(channel, 0.0f, 1.0f);
    const Colour3 lab = hunt_lab_from_linear_rgb(rgb);
    seen.y.values[i] = lab[0], seen.cx.values[i] = lab[1], seen.cz.values[i] = lab[2];
  }
  return seen;
}

/// The largest colour difference there is: green against blue.
float largest_colour_difference() {
  const float distance = hyab_distance(hunt_lab_from_linear_rgb({0, 1, 0}), hunt_lab_from_linear_rgb({0, 0, 1}));
  return std::pow(distance, kColourExponent);
}

/// Compresses large differences (section 4.1.3).
float redistributed(float distance, float largest) {
  const float error = std::pow(distance, kColourExponent), knee = kKneeAt * largest;
  if (error < knee) return kKneeValue / knee * error;
  return kKneeValue + (error - knee) / (largest - knee) * (1.0f - kKneeValue);
}

/// Kernels over the feature filters' support: a Gaussian of sum 1, its first and its second derivative, each scaled
/// so that its positive and its negative taps sum to 1 and -1 (section 4.2.1).
struct FeatureKernels {
  Kernel gaussian, edge, point;
};

void balance(Kernel& kernel) {
  float positive = 0, negative = 0;
  for (const float k : kernel) (k > 0 ? positive : negative) += k;
  for (float& k : kernel) k /= k > 0 ? positive : -negative;
}

FeatureKernels feature_kernels(double ppd) {
  const double deviation = 0.5 * kFeatureWidth * ppd;
  const int radius = static_cast<int>(std::ceil(3.0 * deviation));
  FeatureKernels kernels;
  float sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    const double g = std::exp(-i * i / (2.0 * deviation * deviation));
    kernels.gaussian.push_back(static_cast<float>(g));
    kernels.edge.push_back(static_cast<float>(-i * g));
    kernels.point.push_back(static_cast<float>((i * i / (deviation * deviation) - 1.0) * g));
    sum += kernels.gaussian.back();
  }
  for (float& k : kernels.gaussian) k /= sum;
  balance(kernels.edge);
  balance(kernels.point);
  return kernels;
}

struct Features {
  ImageF edge, point;  // lengths of the responses along x and y
};

Features find_features(const ImageF& y, const FeatureKernels& kernels) {
  ImageF luminance = y;
  for (float& value : luminance.values) value = (value + 16.0f) / 116.0f;
  const auto length = [](ImageF a, const ImageF& b) {
    for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] = std::hypot(a.values[i], b.values[i]);
    return a;
  };
  const ImageF smooth_rows = convolve_rows(luminance, kernels.gaussian);
  return {length(convolve(luminance, kernels.edge, kernels.gaussian), convolve_columns(smooth_rows, kernels.edge)),
          length(convolve(luminance, kernels.point, kernels.gaussian), convolve_columns(smooth_rows, kernels.point))};
}

}  // namespace

FlipResult flip(const Image8& reference, const Image8& test, double ppd) {
  assert(reference.same_size(test) && reference.pixels() > 0 && reference.channels >= 3 && test.channels >= 3);
  const Planes reference_planes = opponent_planes(reference), test_planes = opponent_planes(test);
  const Planes seen_reference = perceived_planes(reference_planes, ppd), seen_test = perceived_planes(test_planes, ppd);
  const FeatureKernels kernels = feature_kernels(ppd);
  const Features reference_features = find_features(reference_planes.y, kernels),
                 test_features = find_features(test_planes.y, kernels);
  const float largest = largest_colour_difference();

  FlipResult result;
  result.error = ImageF(reference.width, reference.height, 1);
  double sum = 0;
  for (std::size_t i = 0; i < result.error.values.size(); ++i) {
    const float distance =
        hyab_distance({seen_reference.y.values[i], seen_reference.cx.values[i], seen_reference.cz.values[i]},
                      {seen_test.y.values[i], seen_test.cx.values[i], seen_test.cz.values[i]});
    const float colour = redistributed(distance, largest);
    const float edge = std::fabs(reference_features.edge.values[i] - test_features.edge.values[i]);
    const float point = std::fabs(reference_features.point.values[i] - test_features.point.values[i]);
    const float feature = std::pow(std::max(edge, point) / std::numbers::sqrt2_v<float>, kFeatureExponent);  // eq. 5
    result.error.values[i] = std::pow(colour, 1.0f - feature);                                               // eq. 6
    sum += result.error.values[i];
  }
  result.mean = sum / static_cast<double>(result.error.values.size());
  return result;
}

}  // namespace farfield

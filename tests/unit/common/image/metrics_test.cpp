// SPDX-License-Identifier: Apache-2.0
// PSNR, SSIM and FLIP against closed forms, frozen values, and slow direct implementations written apart from ours.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "common/image/flip.h"
#include "common/image/psnr.h"
#include "common/image/ssim.h"

namespace farfield {
namespace {

Image8 uniform_image(int width, int height, int r, int g, int b) {
  Image8 image(width, height, 3);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    image.values[3 * i] = static_cast<std::uint8_t>(r);
    image.values[3 * i + 1] = static_cast<std::uint8_t>(g);
    image.values[3 * i + 2] = static_cast<std::uint8_t>(b);
  }
  return image;
}

Image8 pattern(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Image8 image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double wave = 120 + 80 * std::sin(0.3 * x + c) * std::cos(0.2 * y - c) + (x > y ? 30 : -30);
        image.at(x, y)[c] = static_cast<std::uint8_t>(std::clamp(wave + static_cast<int>(random() % 21) - 10.0, 0.0, 255.0));
      }
    }
  }
  return image;
}

TEST(Psnr, ClosedForms) {
  const Image8 a = uniform_image(8, 8, 100, 100, 100);
  EXPECT_EQ(psnr_db(a, a), kMaxPsnrDb);
  EXPECT_NEAR(psnr_db(a, uniform_image(8, 8, 101, 101, 101)), 48.1308036, 1e-6);  // 20·log10(255)
  EXPECT_NEAR(psnr_db(uniform_image(8, 8, 0, 0, 0), uniform_image(8, 8, 255, 255, 255)), 0, 1e-12);
  EXPECT_NEAR(psnr_db(a, uniform_image(8, 8, 103, 100, 100)), 10 * std::log10(65025.0 / 3), 1e-9);
}

TEST(Psnr, MaskAndAlpha) {
  Image8 a(4, 1, 4, 10), b(4, 1, 4, 10);
  b.at(1, 0)[0] = 20;
  b.at(2, 0)[3] = 99;  // alpha does not count
  const std::vector<std::uint8_t> without{1, 0, 1, 1}, only{0, 1, 0, 0}, none{0, 0, 0, 0};
  EXPECT_EQ(psnr_db(a, b, without), kMaxPsnrDb);
  EXPECT_NEAR(psnr_db(a, b, only), 10 * std::log10(65025.0 * 3 / 100), 1e-9);
  EXPECT_EQ(psnr_db(a, b, none), kMaxPsnrDb);
}

double luma(const Image8& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
}

/// Window by window, in double, with deviations from the window's own mean.
double slow_ssim(const Image8& a, const Image8& b) {
  double weights[11][11], total = 0;
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 11; ++i) total += weights[j][i] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / 4.5);
  }
  const double c1 = 6.5025, c2 = 58.5225;
  double sum = 0;
  int windows = 0;
  for (int y = 0; y + 11 <= a.height; ++y) {
    for (int x = 0; x + 11 <= a.width; ++x, ++windows) {
      double mu_a = 0, mu_b = 0, va = 0, vb = 0, cov = 0;
      const auto each = [&](auto&& f) {
        for (int j = 0; j < 11; ++j) {
          for (int i = 0; i < 11; ++i) f(weights[j][i] / total, luma(a, x + i, y + j), luma(b, x + i, y + j));
        }
      };
      each([&](double w, double p, double q) { mu_a += w * p, mu_b += w * q; });
      each([&](double w, double p, double q) {
        va += w * (p - mu_a) * (p - mu_a), vb += w * (q - mu_b) * (q - mu_b), cov += w * (p - mu_a) * (q - mu_b);
      });
      sum += (2 * mu_a * mu_b + c1) * (2 * cov + c2) / ((mu_a * mu_a + mu_b * mu_b + c1) * (va + vb + c2));
    }
  }
  return sum / windows;
}

TEST(Ssim, ClosedForms) {
  const Image8 a = pattern(40, 30, 1);
  EXPECT_NEAR(ssim(a, a), 1, 1e-6);
  // Uniform images: only the luminance term is left.
  const double expected = (2.0 * 100 * 150 + 6.5025) / (100.0 * 100 + 150.0 * 150 + 6.5025);
  EXPECT_NEAR(ssim(uniform_image(16, 16, 100, 100, 100), uniform_image(16, 16, 150, 150, 150)), expected, 1e-5);
}

TEST(Ssim, AgreesWithTheDirectForm) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    const Image8 a = pattern(37, 29, seed), b = pattern(37, 29, seed + 10);
    const double value = ssim(a, b);
    EXPECT_NEAR(value, slow_ssim(a, b), 1e-4);
    EXPECT_LT(value, 0.99);
  }
}

// FLIP, slowly: two-dimensional kernels, double precision, everything from the paper's formulae once more.
using Vector = std::array<double, 3>;

double to_linear(int code) {
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
constexpr double kToXyz[3][3] = {{0.4123865632529917, 0.35759149092062537, 0.18045049120356368},
                                 {0.21263682167732384, 0.7151829818412507, 0.07218019648142547},
                                 {0.019330620152483987, 0.11919716364020845, 0.9503725870054354}};
constexpr double kToRgb[3][3] = {{3.2410032329763587, -1.5373989694887855, -0.4986158819963629},
                                 {-0.9692242522025166, 1.8759299836951760, 0.0415542263400847},
                                 {0.0556394198519755, -0.2040112061239099, 1.0571489771875333}};
constexpr double kD65[3] = {0.950428545377181, 1.0, 1.088900370798128};

Vector transform(const double (&m)[3][3], const Vector& v) {
  Vector r{};
  for (int i = 0; i < 3; ++i) r[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return r;
}
Vector ycxcz(const std::uint8_t* p) {
  const Vector xyz = transform(kToXyz, {to_linear(p[0]), to_linear(p[1]), to_linear(p[2])});
  return {116 * xyz[1] - 16, 500 * (xyz[0] / kD65[0] - xyz[1]), 200 * (xyz[1] - xyz[2] / kD65[2])};
}
Vector hunt_lab(const Vector& rgb) {
  const Vector xyz = transform(kToXyz, rgb);
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : t * 841 / 108 + 4.0 / 29; };
  const double x = f(xyz[0] / kD65[0]), y = f(xyz[1]), z = f(xyz[2] / kD65[2]), l = 116 * y - 16;
  return {l, 0.01 * l * 500 * (x - y), 0.01 * l * 200 * (y - z)};
}
double hyab(const Vector& a, const Vector& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}
Vector filtered_pixel(const Image8& image, int x, int y, int radius,
                      const std::function<Vector(int, int)>& weight, const std::function<Vector(const std::uint8_t*)>& value) {
  Vector sum{};
  for (int j = -radius; j <= radius; ++j) {
    for (int i = -radius; i <= radius; ++i) {
      const Vector v = value(image.at(std::clamp(x + i, 0, image.width - 1), std::clamp(y + j, 0, image.height - 1)));
      const Vector w = weight(i, j);
      for (int c = 0; c < 3; ++c) sum[c] += w[c] * v[c];
    }
  }
  return sum;
}

double slow_flip_pixel(const Image8& reference, const Image8& test, int x, int y) {
  const double ppd = 67, pi = M_PI;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * ppd));
  const auto raw = [&](int i, int j) {
    const double z = (i * i + j * j) / (ppd * ppd);
    const auto term = [&](double a, double b) { return a * std::sqrt(pi / b) * std::exp(-pi * pi * z / b); };
    return Vector{term(1, 0.0047), term(1, 0.0053), term(34.1, 0.04) + term(13.5, 0.025)};
  };
  Vector total{};
  for (int j = -radius; j <= radius; ++j) {
    for (int i = -radius; i <= radius; ++i) {
      for (int c = 0; c < 3; ++c) total[c] += raw(i, j)[c];
    }
  }
  const auto weight = [&](int i, int j) {
    const Vector w = raw(i, j);
    return Vector{w[0] / total[0], w[1] / total[1], w[2] / total[2]};
  };
  const auto seen = [&](const Image8& image) {
    const Vector c = filtered_pixel(image, x, y, radius, weight, ycxcz);
    const double yy = (c[0] + 16) / 116;
    Vector rgb = transform(kToRgb, {(yy + c[1] / 500) * kD65[0], yy, (yy - c[2] / 200) * kD65[2]});
    for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
    return hunt_lab(rgb);
  };
  const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
  double colour = std::pow(hyab(seen(reference), seen(test)), 0.7);
  const double knee = 0.4 * largest;
  colour = colour < knee ? 0.95 / knee * colour : 0.95 + (colour - knee) / (largest - knee) * 0.05;

  const double deviation = 0.5 * 0.082 * ppd;
  const int reach = static_cast<int>(std::ceil(3 * deviation));
  const auto features = [&](const Image8& image, bool is_point) {
    const auto kernel = [&](int i, int j) {
      const double g = std::exp(-(i * i + j * j) / (2 * deviation * deviation));
      return is_point ? (i * i / (deviation * deviation) - 1) * g : -i * g;
    };
    double positive = 0, negative = 0;
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) (kernel(i, j) > 0 ? positive : negative) += std::abs(kernel(i, j));
    }
    const auto balanced = [&](int i, int j) { return kernel(i, j) / (kernel(i, j) > 0 ? positive : negative); };
    const auto both = [&](int i, int j) { return Vector{balanced(i, j), balanced(j, i), 0}; };
    const auto light = [](const std::uint8_t* p) {
      const double v = (ycxcz(p)[0] + 16) / 116;
      return Vector{v, v, 0};
    };
    const Vector r = filtered_pixel(image, x, y, reach, both, light);
    return std::hypot(r[0], r[1]);
  };
  const double edge = std::abs(features(reference, false) - features(test, false));
  const double point = std::abs(features(reference, true) - features(test, true));
  return std::pow(colour, 1 - std::sqrt(std::max(edge, point) / std::sqrt(2.0)));
}

TEST(Flip, UniformColours) {
  const auto mean = [](std::array<int, 3> a, std::array<int, 3> b) {
    return flip(uniform_image(24, 20, a[0], a[1], a[2]), uniform_image(24, 20, b[0], b[1], b[2])).mean;
  };
  EXPECT_NEAR(mean({0, 255, 0}, {0, 0, 255}), 1, 1e-4);  // the largest difference, by definition
  EXPECT_NEAR(mean({0, 0, 0}, {255, 255, 255}), 0.96741, 1e-4);
  EXPECT_NEAR(mean({90, 30, 200}, {90, 30, 200}), 0, 1e-6);
  EXPECT_NEAR(mean({255, 0, 0}, {0, 255, 0}), slow_flip_pixel(uniform_image(24, 20, 255, 0, 0), uniform_image(24, 20, 0, 255, 0), 12, 10), 1e-4);
}

TEST(Flip, AgreesWithTheDirectForm) {
  const Image8 a = pattern(31, 27, 1);
  Image8 b = pattern(31, 27, 2);
  for (int y = 5; y < 15; ++y) {
    for (int x = 8; x < 12; ++x) b.at(x, y)[0] = 255, b.at(x, y)[1] = 0;
  }
  const FlipResult result = flip(a, b);
  double largest = 0;
  for (const auto& [x, y] : {std::pair{0, 0}, {15, 13}, {30, 26}, {9, 10}, {13, 6}, {3, 20}, {28, 2}}) {
    EXPECT_NEAR(*result.error.at(x, y), slow_flip_pixel(a, b, x, y), 2e-4) << x << " " << y;
    largest = std::max<double>(largest, *result.error.at(x, y));
  }
  EXPECT_GT(largest, 0.3);
  double sum = 0;
  for (const float e : result.error.values) sum += e;
  EXPECT_NEAR(result.mean, sum / result.error.pixels(), 1e-9);
}

TEST(Flip, IsSymmetricAndBounded) {
  const Image8 a = pattern(40, 20, 3), b = pattern(40, 20, 4);
  EXPECT_NEAR(flip(a, b).mean, flip(b, a).mean, 1e-6);
  for (const float e : flip(a, b).error.values) EXPECT_TRUE(e >= 0 && e <= 1);
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/image/flip_colour.h"

#include <cmath>

namespace farfield {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// sRGB primaries and D65 as exact fractions, the constants the paper's authors use.
constexpr Matrix kXyzFromRgb{{{10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0},
                              {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
                              {1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0}}};

constexpr Matrix inverse(const Matrix& m) {
  const auto cofactor = [&](int r, int c) {
    const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  Matrix result{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) result[c][r] = cofactor(r, c) / determinant;
  }
  return result;
}
constexpr Matrix kRgbFromXyz = inverse(kXyzFromRgb);

/// XYZ of white: the sums of the rows.
constexpr std::array<double, 3> kWhite{kXyzFromRgb[0][0] + kXyzFromRgb[0][1] + kXyzFromRgb[0][2],
                                       kXyzFromRgb[1][0] + kXyzFromRgb[1][1] + kXyzFromRgb[1][2],
                                       kXyzFromRgb[2][0] + kXyzFromRgb[2][1] + kXyzFromRgb[2][2]};

/// XYZ relative to white.
Colour3 relative_xyz(const Colour3& rgb) {
  Colour3 xyz;
  for (int k = 0; k < 3; ++k) {
    xyz[k] = static_cast<float>((kXyzFromRgb[k][0] * rgb[0] + kXyzFromRgb[k][1] * rgb[1] + kXyzFromRgb[k][2] * rgb[2]) /
                                kWhite[k]);
  }
  return xyz;
}

float lab_curve(float t) {
  constexpr float kDelta = 6.0f / 29.0f;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
}

std::array<float, 256> make_decoding() {
  std::array<float, 256> table;
  for (int c = 0; c < 256; ++c) {
    const double code = c / 255.0;
    table[c] = static_cast<float>(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
  }
  return table;
}

}  // namespace

Colour3 linear_rgb_from_srgb(const std::uint8_t* srgb) {
  static const std::array<float, 256> decoding = make_decoding();
  return {decoding[srgb[0]], decoding[srgb[1]], decoding[srgb[2]]};
}

Colour3 ycxcz_from_linear_rgb(const Colour3& rgb) {
  const Colour3 t = relative_xyz(rgb);
  return {116.0f * t[1] - 16.0f, 500.0f * (t[0] - t[1]), 200.0f * (t[1] - t[2])};
}

Colour3 linear_rgb_from_ycxcz(const Colour3& c) {
  const double y = (c[0] + 16.0) / 116.0;
  const double x = (y + c[1] / 500.0) * kWhite[0], z = (y - c[2] / 200.0) * kWhite[2];
  Colour3 rgb;
  for (int k = 0; k < 3; ++k) {
    rgb[k] = static_cast<float>(kRgbFromXyz[k][0] * x + kRgbFromXyz[k][1] * y * kWhite[1] + kRgbFromXyz[k][2] * z);
  }
  return rgb;
}

Colour3 hunt_lab_from_linear_rgb(const Colour3& rgb) {
  const Colour3 t = relative_xyz(rgb);
  const float fx = lab_curve(t[0]), fy = lab_curve(t[1]), fz = lab_curve(t[2]);
  const float lightness = 116.0f * fy - 16.0f, hunt = 0.01f * lightness;
  return {lightness, hunt * 500.0f * (fx - fy), hunt * 200.0f * (fy - fz)};
}

float hyab_distance(const Colour3& a, const Colour3& b) {
  const float da = a[1] - b[1], db = a[2] - b[2];
  return std::fabs(a[0] - b[0]) + std::sqrt(da * da + db * db);
}

}  // namespace farfield

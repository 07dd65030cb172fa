// SPDX-License-Identifier: Apache-2.0
#include "client/near_cpu/shade_pixels.h"

#include <algorithm>
#include <cmath>

#include "client/warp/splat_key.h"
#include "client/warp/splat_pixel.h"

namespace farfield::client {
namespace {

constexpr int kVector = 16;
constexpr int kMost = 64;  // pixels at once: arrays of them stay in registers and the first-level cache
constexpr std::uint32_t kNearBit = 1u << 24;

/// The sRGB code of linear light, off by at most 0.04 before it is rounded: a polynomial of the square root, Chebyshev-fitted
/// to 1.055·x^(1/2.4) − 0.055 above the code's linear part.
inline std::uint32_t srgb_code(float linear) {
  const float x = clamped(linear, 0.0f, 1.0f), s = std::sqrt(x);
  const float curve =
      (((((-0.94715929f * s + 3.41690159f) * s - 5.00078678f) * s + 3.89691758f) * s - 1.89899755f) * s + 1.57520354f) * s - 0.04222880f;
  const float code = x <= 0.0031308f ? 12.92f * x : curve;
  return static_cast<std::uint32_t>(static_cast<int>(255.0f * code + 0.5f));
}

/// A function of the pixel in a row, of pixels counted from `begin`: small numbers, floats are enough.
struct FromPixel {
  float origin, along_x;
  FromPixel(const PixelLinear& f, int y, int begin)
      : origin(static_cast<float>(f.row(y) + f.along_x * begin)), along_x(static_cast<float>(f.along_x)) {}
  float at(int i) const { return origin + along_x * static_cast<float>(i); }
};

/// Texture coordinates, and the texels that a pixel covers: |det ∂(u, v)/∂(x, y)| of the finest level.
void apply_texture(const RasterTriangle& t, int y, int begin, int count, const float* w, float* const light[3]) {
  alignas(64) std::array<float, kMost> u, v, area;
  const FromPixel u_over_w(t.u, y, begin), v_over_w(t.v, y, begin);
  const auto u_x = static_cast<float>(t.u.along_x), u_y = static_cast<float>(t.u.along_y);
  const auto v_x = static_cast<float>(t.v.along_x), v_y = static_cast<float>(t.v.along_y);
  const auto d_x = static_cast<float>(t.disparity.along_x), d_y = static_cast<float>(t.disparity.along_y);
  const float texels = static_cast<float>(t.texture->width()) * static_cast<float>(t.texture->height());
  for (int i = 0; i < count; ++i) {
    u[i] = u_over_w.at(i) * w[i], v[i] = v_over_w.at(i) * w[i];
    const float det = (u_x - u[i] * d_x) * (v_y - v[i] * d_y) - (u_y - u[i] * d_y) * (v_x - v[i] * d_x);
    area[i] = std::fabs(det) * w[i] * w[i] * texels;
  }
  t.texture->multiply(count, u.data(), v.data(), area.data(), light);
}

/// `count` pixels from `begin`, at most kMost.
void shade_some(const RasterTriangle& t, int y, int begin, int count, std::uint64_t* keys) {
  alignas(64) std::array<float, kMost> w;
  alignas(64) std::array<std::array<float, kMost>, 3> light;
  alignas(64) std::array<std::uint32_t, kMost> low;
  const int whole = (count + kVector - 1) / kVector * kVector;  // vectors; what is left over shows nothing
  for (int i = 0; i < whole; ++i) w[i] = 1;
  for (int i = 0; i < count; ++i) w[i] = 1.0f / key_disparity(keys[begin + i]);
  for (int c = 0; c < 3; ++c) {
    const FromPixel over_w(t.radiance[static_cast<std::size_t>(c)], y, begin);
    float* __restrict out = light[static_cast<std::size_t>(c)].data();
    for (int i = 0; i < whole; ++i) out[i] = over_w.at(i) * w[i];
  }
  if (t.texture) {
    float* const channels[3] = {light[0].data(), light[1].data(), light[2].data()};
    apply_texture(t, y, begin, whole, w.data(), channels);
  }
  for (int i = 0; i < whole; ++i) low[i] = srgb_code(light[0][i]) | srgb_code(light[1][i]) << 8 | srgb_code(light[2][i]) << 16 | kNearBit;
  for (int i = 0; i < count; ++i) keys[begin + i] = (keys[begin + i] >> 32 << 32) | low[i];
}

}  // namespace

void shade_pixels(const RasterTriangle& triangle, int y, int begin, int end, std::uint64_t* keys) {
  if (triangle.has_one_colour && !triangle.texture) {
    for (int x = begin; x < end; ++x) keys[x] = (keys[x] >> 32 << 32) | triangle.colour | kNearBit;
    return;
  }
  for (int x = begin; x < end; x += kMost) shade_some(triangle, y, x, std::min(kMost, end - x), keys);
}

}  // namespace farfield::client

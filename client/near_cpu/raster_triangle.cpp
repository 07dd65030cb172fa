// SPDX-License-Identifier: Apache-2.0
#include "client/near_cpu/raster_triangle.h"

#include <algorithm>
#include <cmath>

#include "client/warp/splat_key.h"
#include "client/warp/splat_pixel.h"
#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr int kBlock = 8;  // pixels at once: one vector of keys

PixelLinear at_pixels(const glm::dvec3& by_place) {
  // From pixel coordinates to the centres of pixels.
  return {by_place.z + 0.5 * (by_place.x + by_place.y), by_place.x, by_place.y};
}

/// Sets the pixels whose centres can lie inside. Returns: false if there are none.
bool find_pixels(const std::array<RasterCorner, 3>& corners, int width, int height, RasterTriangle& out) {
  out.left = out.top = 0, out.right = width - 1, out.bottom = height - 1;
  const auto is_in_front = [](const RasterCorner& c) { return c.place.z > 0; };
  if (std::none_of(corners.begin(), corners.end(), is_in_front)) return false;
  if (!std::all_of(corners.begin(), corners.end(), is_in_front)) return true;  // it may reach everywhere
  double x_low = width, x_high = 0, y_low = height, y_high = 0;
  for (const RasterCorner& c : corners) {
    const double x = c.place.x / c.place.z, y = c.place.y / c.place.z;
    x_low = std::min(x_low, x), x_high = std::max(x_high, x), y_low = std::min(y_low, y), y_high = std::max(y_high, y);
  }
  // A pixel more on either side: which centres lie inside, the edges decide.
  out.left = static_cast<int>(std::max(std::floor(x_low - 0.5), 0.0)), out.top = static_cast<int>(std::max(std::floor(y_low - 0.5), 0.0));
  out.right = static_cast<int>(std::min(std::ceil(x_high - 0.5), width - 1.0));
  out.bottom = static_cast<int>(std::min(std::ceil(y_high - 0.5), height - 1.0));
  return out.left <= out.right && out.top <= out.bottom;
}

/// Narrows [left, right] to where none of the edges is negative in a row, and at most a pixel more.
void narrow(const RasterTriangle& t, int y, int& left, int& right) {
  double low = left, high = right;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along_x = t.edges[k].along_x, zero = t.zero[k] + t.zero_per_row[k] * y;
    if (along_x > 0) low = std::max(low, std::floor(zero));
    if (along_x < 0) high = std::min(high, std::ceil(zero));
  }
  if (!(low <= high)) low = right + 1.0, high = right;
  left = static_cast<int>(low), right = static_cast<int>(high);
}

/// The row's functions in float: every triangle with the same edge rounds alike.
struct RowFunction {
  float origin, along_x;
  RowFunction(const PixelLinear& f, int y) : origin(static_cast<float>(f.row(y))), along_x(static_cast<float>(f.along_x)) {}
  float at(int x) const { return origin + along_x * static_cast<float>(x); }
};

struct TriangleRow {
  RowFunction a, b, c, disparity;
  int left;  // disparities are counted from there: small numbers, floats are enough
  float largest_disparity;

  TriangleRow(const RasterTriangle& t, float largest, int y)
      : a(t.edges[0], y), b(t.edges[1], y), c(t.edges[2], y), disparity(t.disparity, y), left(t.left), largest_disparity(largest) {
    disparity.origin = static_cast<float>(t.disparity.row(y) + t.disparity.along_x * left);
  }
  /// key_high() at a pixel's centre, or 0 if it is not covered.
  std::uint32_t high(int x) const {
    const float nearness = disparity.at(x - left);
    const int covers = mask_of(a.at(x) >= 0) & mask_of(b.at(x) >= 0) & mask_of(c.at(x) >= 0) & mask_of(nearness > 0) &
                       mask_of(nearness <= largest_disparity);
    return key_high(nearness) & static_cast<std::uint32_t>(covers);
  }
};

bool is_transparent(const RasterTriangle& t, int x, int y) {
  const double w = 1 / (t.disparity.row(y) + t.disparity.along_x * x);
  const double u = (t.u.row(y) + t.u.along_x * x) * w, v = (t.v.row(y) + t.v.along_x * x) * w;
  return t.texture->alpha_at(static_cast<float>(u), static_cast<float>(v)) < t.alpha_cutoff;
}

}  // namespace

bool place_triangle(const std::array<RasterCorner, 3>& corners, int width, int height, RasterTriangle& out) {
  if (!find_pixels(corners, width, height, out)) return false;
  const glm::dvec3 &a = corners[0].place, &b = corners[1].place, &c = corners[2].place;
  const std::array<glm::dvec3, 3> across{glm::cross(b, c), glm::cross(c, a), glm::cross(a, b)};
  const double volume = glm::dot(a, across[0]), per_volume = 1 / volume;
  if (!(std::fabs(volume) > 0) || !std::isfinite(per_volume)) return false;  // seen edge-on
  // The edges themselves stay undivided: both of an edge's triangles must have the same numbers.
  for (std::size_t k = 0; k < 3; ++k) {
    const PixelLinear edge = out.edges[k] = at_pixels(volume > 0 ? across[k] : -across[k]);
    out.zero[k] = -edge.origin / edge.along_x, out.zero_per_row[k] = -edge.along_y / edge.along_x;  // not used where it is level
  }
  const auto interpolated = [&](auto&& value_of) {
    glm::dvec3 sum{0};
    for (std::size_t k = 0; k < 3; ++k) sum += static_cast<double>(value_of(*corners[k].vertex)) * per_volume * across[k];
    return at_pixels(sum);
  };
  out.disparity = interpolated([](const SurfaceVertex&) { return 1.0; });
  for (int channel = 0; channel < 3; ++channel)
    out.radiance[static_cast<std::size_t>(channel)] = interpolated([&](const SurfaceVertex& v) { return v.radiance[channel] * (1.0 / 65535); });
  out.u = interpolated([](const SurfaceVertex& v) { return v.uv.x; }), out.v = interpolated([](const SurfaceVertex& v) { return v.uv.y; });
  const glm::u16vec4 radiance = corners[0].vertex->radiance;
  out.has_one_colour = corners[1].vertex->radiance == radiance && corners[2].vertex->radiance == radiance;
  out.colour = 0;
  for (int channel = 0; channel < 3; ++channel)
    out.colour |= static_cast<std::uint32_t>(linear_to_srgb(static_cast<float>(radiance[channel]) / 65535.0f)) << (8 * channel);
  return true;
}

void draw_triangle_row(const RasterTriangle& triangle, std::uint32_t number, float largest_disparity, int y, int width,
                       std::uint64_t* keys) {
  int left = triangle.left, right = triangle.right;
  narrow(triangle, y, left, right);
  const TriangleRow row(triangle, largest_disparity, y);
  for (int x = left & -kBlock; x <= right; x += kBlock) {
    std::array<std::uint32_t, kBlock> high;
    std::uint64_t* at = keys + x;
    if (x + kBlock > width || triangle.is_alpha_masked) {
      for (int k = 0; k < std::min(kBlock, width - x); ++k) {
        const std::uint64_t key = make_key(row.high(x + k), number);
        if (key >> 32 == 0 || key < at[k] || (triangle.is_alpha_masked && is_transparent(triangle, x + k, y))) continue;
        at[k] = key;
      }
      continue;
    }
    for (int k = 0; k < kBlock; ++k) high[static_cast<std::size_t>(k)] = row.high(x + k);
    for (int k = 0; k < kBlock; ++k) {
      const std::uint32_t own = high[static_cast<std::size_t>(k)];
      const std::uint64_t key = make_key(own, number & (0u - (own & 1)));  // its lowest bit is set where there is any
      at[k] = at[k] < key ? key : at[k];
    }
  }
}

}  // namespace farfield::client

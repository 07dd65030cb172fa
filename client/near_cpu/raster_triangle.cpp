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

/// Of a triangle that reaches behind the eye: the rows of its part at least `least_w` before it. Returns: false if there are none.
bool find_rows(const std::array<RasterCorner, 3>& corners, double least_w, int height, RasterTriangle& out) {
  double y_low = height, y_high = 0;
  const auto take = [&](double y) { y_low = std::min(y_low, y), y_high = std::max(y_high, y); };
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = corners[k].place, &b = corners[(k + 1) % 3].place;
    if (a.z >= least_w) take(a.y / a.z);
    if ((a.z >= least_w) != (b.z >= least_w)) take((a.y + (b.y - a.y) * ((least_w - a.z) / (b.z - a.z))) / least_w);
  }
  out.top = static_cast<int>(std::clamp(std::floor(y_low - 0.5), 0.0, height - 0.0));
  out.bottom = static_cast<int>(std::clamp(std::ceil(y_high - 0.5), -1.0, height - 1.0));
  return out.top <= out.bottom;
}

/// Sets the pixels whose centres can lie inside. Returns: false if there are none.
bool find_pixels(const std::array<RasterCorner, 3>& corners, double least_w, int width, int height, RasterTriangle& out) {
  out.left = out.top = 0, out.right = width - 1, out.bottom = height - 1;
  const auto is_in_front = [](const RasterCorner& c) { return c.place.z > 0; };
  if (std::none_of(corners.begin(), corners.end(), is_in_front)) return false;
  if (!std::all_of(corners.begin(), corners.end(), is_in_front)) return find_rows(corners, least_w, height, out);
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

/// Rows looked at together, and what to look at in each: columns [left, right].
constexpr int kRows = 16;
struct Spans {
  alignas(64) std::array<std::int32_t, kRows> left, right;
};

/// Of rows from `first` on, where none of the edges is negative, and at most a pixel more. Far more rows of thin triangles and of
/// those that reach out of the frame are found empty here than are drawn.
void find_spans(const RasterTriangle& t, int first, Spans& out) {
  alignas(64) std::array<double, kRows> low, high;
  low.fill(t.left), high.fill(t.right);
  for (std::size_t k = 0; k < 3; ++k) {
    const double along_x = t.edges[k].along_x, zero = t.zero[k], per_row = t.zero_per_row[k];
    if (along_x > 0) {
      for (int i = 0; i < kRows; ++i) low[i] = std::max(low[i], std::floor(zero + per_row * (first + i)));
    } else if (along_x < 0) {
      for (int i = 0; i < kRows; ++i) high[i] = std::min(high[i], std::ceil(zero + per_row * (first + i)));
    }
  }
  const double left = t.left, right = t.right;
  for (int i = 0; i < kRows; ++i) {
    const double from = low[i] <= high[i] ? low[i] : right, to = low[i] <= high[i] ? high[i] : left - 1;
    out.left[i] = static_cast<std::int32_t>(from), out.right[i] = static_cast<std::int32_t>(to);
  }
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

/// Columns [left, right] of one row.
void draw_row(const RasterTriangle& triangle, std::uint32_t number, float largest_disparity, int y, int left, int right, int width,
              std::uint64_t* keys) {
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

}  // namespace

bool place_triangle(const std::array<RasterCorner, 3>& corners, float largest_disparity, int width, int height, RasterTriangle& out) {
  // A pixel's disparity is rounded to a float, and so was the largest.
  if (!find_pixels(corners, (1 - 0x1p-22) / largest_disparity, width, height, out)) return false;
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

void draw_triangle(const RasterTriangle& triangle, std::uint32_t number, float largest_disparity, int first_row, int last_row, int width,
                   std::uint64_t* keys) {
  const int end = std::min(triangle.bottom + 1, last_row);
  Spans spans;
  for (int first = std::max(triangle.top, first_row); first < end; first += kRows) {
    find_spans(triangle, first, spans);
    for (int i = 0; i < std::min(kRows, end - first); ++i) {
      if (spans.left[i] > spans.right[i]) continue;
      const int y = first + i;
      draw_row(triangle, number, largest_disparity, y, spans.left[i], spans.right[i], width,
               keys + static_cast<std::size_t>(y) * static_cast<std::size_t>(width));
    }
  }
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
// From directions and samples to pixels, against the same formulas in long double: every field of view, every pitch, and
// disparities from infinity to the near region's border.
#include <fmt/format.h>

#include <memory>
#include <random>

#include "client/warp/project_row.h"
#include "client/warp/tile_projection.h"
#include "common/cells/sampling.h"
#include "common/math/cube_face.h"
#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

using Real = long double;
using client::kRowPiece;

constexpr double kPi = 3.14159265358979323846;

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  unsigned below(unsigned count) { return static_cast<unsigned>(random_() % count); }
  /// A camera that looks anywhere, or straight up or down, turned about that axis.
  glm::dquat rotation() {
    const glm::dquat turn = glm::angleAxis(between(-kPi, kPi), glm::dvec3(0, 1, 0));
    const unsigned kind = below(3);
    if (kind == 2) return glm::normalize(turn * glm::angleAxis(between(-kPi / 2, kPi / 2), glm::dvec3(1, 0, 0)));
    return glm::normalize(turn * glm::angleAxis(kind ? kPi / 2 : -kPi / 2, glm::dvec3(1, 0, 0)));
  }

 private:
  std::mt19937 random_;
};

// R^T·d for the rotation of a unit quaternion, in long double from its double components.
Long3 to_camera(const glm::dquat& q, const Long3& d) {
  const Real norm = std::sqrt(Real(q.w) * q.w + Real(q.x) * q.x + Real(q.y) * q.y + Real(q.z) * q.z);
  const Real w = q.w / norm;
  const Long3 v = Long3(q.x, q.y, q.z) / -norm;  // the inverse turns the other way
  return d + Real(2) * glm::cross(v, glm::cross(v, d) + w * d);
}

struct Screen {
  Real x, y, w;
};
Screen screen_of(const Long3& in_camera, const Display& display) {
  const Real pitch = 2 * std::tan(Real(display.fovy_rad) / 2) / display.height, w = -in_camera.z;
  return {display.width / Real(2) + in_camera.x / w / pitch, display.height / Real(2) - in_camera.y / w / pitch, w};
}

// A pixel's direction, and back. tan, the pitch and its product take five roundings of a number below the frame's size.
StressRow pixel_directions(double fovy_deg) {
  Random random(1);
  const Display display{1920, 1080, fovy_deg * kPi / 180};
  WorstError worst;
  for (int k = 0; k < 20000; ++k) {
    const double x = random.between(0, 1920), y = random.between(0, 1080);
    const Screen back = screen_of(Long3(camera_direction(display, x, y)), display);
    worst.add(static_cast<double>(std::max(std::abs(back.x - x), std::abs(back.y - y))));
  }
  return worst.row(fmt::format("directions of pixels, {} degrees, 1080p", fovy_deg), "long double", "px", 8 * 1920 * 0x1p-53);
}

// Scene direction to pixel by the one matrix of a frame. Each entry of it takes about 16 roundings (quaternion to matrix,
// product), of numbers up to max(W, 2/p); the sum of three and the quotient 6 more. The terms are as large as
// (W/2 + 1/p)·|d|, so that the pixel is off by that over w, and by the pixel's own size times the same for w.
StressRow matrix_of_a_frame(double fovy_deg) {
  Random random(2);
  const Display display{1920, 1080, fovy_deg * kPi / 180};
  WorstError worst;
  for (int k = 0; k < 20000; ++k) {
    const glm::dquat rotation = random.rotation();
    const double x = random.between(0, 1920), y = random.between(0, 1080);
    const glm::dvec3 direction = glm::dmat3(glm::mat3_cast(rotation)) * camera_direction(display, x, y) * random.between(1e-3, 1e3);
    const glm::dvec3 pixel = client::pixels_from_directions(rotation, display) * direction;
    const Screen exact = screen_of(to_camera(rotation, Long3(direction)), display);
    const double terms = (1920 + 1 / display.pixel_pitch()) * glm::length(direction) / static_cast<double>(exact.w);
    worst.add(static_cast<double>(std::max(std::abs(pixel.x / pixel.z - exact.x), std::abs(pixel.y / pixel.z - exact.y))),
              3 * 22 * 0x1p-53 * terms);
  }
  return worst.in_parts_of_bound(fmt::format("directions to pixels, {} degrees, pitch up to 90 degrees", fovy_deg), "long double");
}

// A piece of samples of one tile, an eye near its view, a camera, and what the warper makes of them.
struct Piece {
  client::DecodedTile tile;
  glm::dvec3 eye{0};
  glm::dquat rotation{1, 0, 0, 0};
  client::TileProjection projection;
  client::RowSamples row;
  std::array<float, kRowPiece> disparity{}, slope{}, u{}, v{};
  std::array<std::uint16_t, kRowPiece> reach{};
  std::array<std::uint32_t, kRowPiece> colour{};
  client::ProjectedRow shown;

  Piece(const Display& display, bool in_system, Random& random);
  void project(const Display& display);
};

// `in_system`: eyes in the cell and surfaces beyond its margin. Else any side, and eyes up to 30 sides away.
Piece::Piece(const Display& display, bool in_system, Random& random) {
  const auto anywhere = [&] { return glm::dvec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)); };
  tile.side_m = in_system ? std::ldexp(0.5, static_cast<int>(random.below(12))) : std::pow(10.0, random.between(-4, 7));
  tile.splats.face = static_cast<int>(random.below(6));
  tile.splats.pitch = static_cast<float>(sample_pitch(1562));
  tile.view_position = anywhere() * tile.side_m * 100.0;
  eye = tile.view_position + tile.side_m * (in_system || random.below(2) ? 0.5 : 30.0) * anywhere();
  // Half of the cameras look along a direction of the face, and the samples crowd around it: narrow ones would see none.
  const CubeFace face = CubeFace::of(tile.splats.face);
  const glm::dvec2 middle = random.below(4) ? glm::dvec2(random.between(-1, 1), random.between(-1, 1)) : glm::dvec2(0);
  const bool is_aimed = random.below(2) != 0;
  const double spread = is_aimed ? std::min(1.0, display.tan_half()) : 1.0;
  const glm::dvec3 along = glm::normalize(face.direction(middle.x, middle.y));
  const glm::dvec3 up = std::abs(along.y) > 0.99 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  rotation = is_aimed ? glm::normalize(glm::quatLookAt(along, up)) : random.rotation();
  for (int i = 0; i < kRowPiece; ++i) {
    u[i] = static_cast<float>((is_aimed ? middle.x : 0) + random.between(-spread, spread));
    v[i] = static_cast<float>((is_aimed ? middle.y : 0) + random.between(-spread, spread));
    // Infinity, denormals, and every magnitude up to the margin of the near region.
    disparity[i] = static_cast<float>(0.4 * std::pow(10.0, -random.between(0, in_system ? 4 : 30)));
    if (i % 8 == 0) disparity[i] = 0;
    if (i % 8 == 1) disparity[i] = std::numeric_limits<float>::denorm_min() * static_cast<float>(i);
  }
}

// As the warper's SplatWriter does.
void Piece::project(const Display& display) {
  reach.fill(kReachHalfway);
  row.count = kRowPiece;
  row.disparity = disparity.data(), row.slope_u = row.slope_v = slope.data();
  row.reach = reach.data();
  row.colour = row.colour_left = row.colour_right = row.colour_up = row.colour_down = colour.data();
  projection = client::TileProjection::of(tile, eye, client::pixels_from_directions(rotation, display));
  client::RowProjection in_floats;
  for (int k = 0; k < 3; ++k) {
    in_floats.step_u[k] = static_cast<float>(projection.per_u[k] * tile.splats.pitch);
    in_floats.step_v[k] = static_cast<float>(projection.per_v[k] * tile.splats.pitch);
    in_floats.per_disparity[k] = static_cast<float>(projection.per_disparity[k]);
  }
  in_floats.disparity_scale = static_cast<float>(projection.disparity_scale);
  for (int i = 0; i < kRowPiece; ++i) {
    const glm::dvec3 at = projection.at(u[i], v[i], 0);
    row.infinity_x[i] = static_cast<float>(at.x), row.infinity_y[i] = static_cast<float>(at.y);
    row.infinity_w[i] = static_cast<float>(at.z);
  }
  client::project_row(in_floats, {display.width, 0, display.height}, row, shown);
}

// The warper's whole projection of samples: (X, Y, w) in double, rounded to float at disparity 0, then in floats.
//   X = X0 + d·Xd: X0 and Xd rounded (u each of them, u = 2^-24), product, sum: u·(2|X0| + 4|d·Xd|) at most; w alike;
//   the quotient by its reciprocal 3u|X/w|, and half a pixel less, u(|x| + 1/2). So x is off by
//   u·((2|X0| + 4|d·Xd| + |x|·(2|w0| + 4|d·wd| + 3w))/w + |x| + 1/2), and the double part, 2^-29 of that, by the next whole
//   number of roundings.
void compare_piece(const Display& display, bool in_system, unsigned seed, WorstError& parts, WorstError& pixels) {
  Random random(seed);
  const auto piece = std::make_unique<Piece>(display, in_system, random);
  piece->project(display);
  const CubeFace face = CubeFace::of(piece->tile.splats.face);
  const Long3 from_eye = (Long3(piece->tile.view_position) - Long3(piece->eye)) / Real(piece->tile.side_m);
  for (int i = 0; i < kRowPiece; ++i) {
    const Real d = piece->disparity[i];
    const Screen exact =
        screen_of(to_camera(piece->rotation, Long3(face.direction<Real>(piece->u[i], piece->v[i])) + d * from_eye), display);
    if (!(exact.w > 0 && exact.x > 0 && exact.x < display.width && exact.y > 0 && exact.y < display.height)) continue;
    const double w = static_cast<double>(exact.w), disparity = static_cast<double>(d);
    const double in_w =
        3 * std::abs(double{piece->row.infinity_w[i]}) + 5 * std::abs(disparity * piece->projection.per_disparity.z) + 4 * w;
    // All of that divided by w as it came out: 1 − off_w of the exact one. Where it may be half of it, beside the eye's plane,
    // nothing is promised.
    const double off_w = 0x1p-24 * in_w / w;
    if (off_w > 0.5) continue;
    const auto bound = [&](float at_infinity, double per_disparity, double shown) {
      return 0x1p-24 * ((3 * std::abs(double{at_infinity}) + 5 * std::abs(disparity * per_disparity) + shown * in_w) / w + shown + 0.5) /
             (1 - off_w);
    };
    const double off_x = static_cast<double>(piece->shown.x[i] + Real(0.5) - exact.x);
    const double off_y = static_cast<double>(piece->shown.y[i] + Real(0.5) - exact.y);
    parts.add(off_x, bound(piece->row.infinity_x[i], piece->projection.per_disparity.x, static_cast<double>(exact.x)));
    parts.add(off_y, bound(piece->row.infinity_y[i], piece->projection.per_disparity.y, static_cast<double>(exact.y)));
    pixels.add(std::max(std::abs(off_x), std::abs(off_y)));
  }
}

StressRow samples_to_pixels(double fovy_deg, const Effort& effort) {
  WorstError parts, pixels;
  for (unsigned k = 0; k < (effort.is_full ? 20000u : 1000u); ++k)
    compare_piece({1920, 1080, fovy_deg * kPi / 180}, false, 10 + k, parts, pixels);
  return parts.in_parts_of_bound(fmt::format("samples to pixels, {} degrees, disparity 0, denormal … 0.4", fovy_deg), "long double");
}

// There tile_projection.h promises 10^-3 pixel.
StressRow samples_of_a_cell(const Effort& effort) {
  WorstError parts, pixels;
  for (unsigned k = 0; k < (effort.is_full ? 20000u : 1000u); ++k) compare_piece({1920, 1080}, true, 10 + k, parts, pixels);
  return pixels.row("samples of a cell to pixels, eyes in the cell, 60 degrees, 1080p", "long double", "px", 1e-3);
}

// Sample i of a face to its tangent and back: a product, a sum, a difference and a quotient, of numbers up to N.
StressRow sample_grid() {
  WorstError worst;
  for (int edge = 4; edge <= 8194; edge += 126)
    for (int i = 0; i < edge; ++i) {
      const double u = sample_tangent(edge, i);
      const Real exact = Real(-1) + (Real(i) - Real(0.5)) * 2 / (edge - 2);
      worst.add(static_cast<double>(u - exact), 4 * 0x1p-53);
      worst.add(sample_index(edge, u) - i, 8 * edge * 0x1p-53);
    }
  return worst.in_parts_of_bound("samples of a face to tangents and back", "long double");
}

// Where rays leave boxes of all sizes at all distances from zero. Difference and quotient: two roundings.
StressRow box_exits() {
  Random random(5);
  WorstError worst;
  for (int k = 0; k < 50000; ++k) {
    const double size = std::pow(10.0, random.between(-6, 9)), place = random.below(2) ? 0 : std::pow(10.0, random.between(0, 9));
    Box box;
    box.include(glm::dvec3(place));
    box.include(glm::dvec3(place) + size * glm::dvec3(random.between(0.1, 1), random.between(0.1, 1), random.between(0.1, 1)));
    const glm::dvec3 origin =
        glm::clamp(box.min + box.extent() * glm::dvec3(random.between(0, 1), random.between(0, 1), random.between(0, 1)), box.min, box.max);
    const glm::dvec3 d(random.between(-1, 1), random.below(4) ? random.between(-1, 1) : 0.0,
                       random.below(4) ? random.between(-1, 1) : 5e-324);
    Real exact = INFINITY;
    for (int a = 0; a < 3; ++a)
      if (d[a] != 0) exact = std::min(exact, (Real(d[a] > 0 ? box.max[a] : box.min[a]) - Real(origin[a])) / Real(d[a]));
    worst.add(static_cast<double>(exit_distance(box, origin, d) - exact),
              static_cast<double>(2.001L * 0x1p-53L * exact) + std::numeric_limits<double>::denorm_min());
  }
  return worst.in_parts_of_bound("where rays leave boxes of 10^-6 to 10^9 m", "long double");
}

// How far an error of disparity can turn a sample, against a search six times as fine in (u, v) and exact in d. The grid's
// steps are 1/8 in u and v and 1/16 of the range of d; a largest value inside lies half a step or less from a node, and over
// a distance of δ the gain falls by about δ² of itself: 2/16² + 1/32², just below one per cent.
StressRow warp_gains(const Effort& effort) {
  Random random(6);
  WorstError worst;
  for (int k = 0; k < (effort.is_full ? 60 : 6); ++k) {
    const glm::dvec3 offset = k == 0   ? glm::dvec3(0)
                              : k == 1 ? glm::dvec3(0.5)
                                       : glm::dvec3(random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(-0.5, 0.5));
    const double kappa = k % 3 == 0 ? 2 : k % 3 == 1 ? 1 : 3, gain = warp_gain(offset, kappa);
    Real found = 0;
    for (int f = 0; f < kCubeFaces; ++f) {
      const CubeFace face = CubeFace::of(f);
      const Real nearest = Real(0.5) + kappa - face.sign * offset[face.axis];
      for (int corner = 0; corner < 8; ++corner) {
        const Long3 eye = Long3(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5) - Long3(offset);
        for (int i = 0; i <= 100; ++i)
          for (int j = 0; j <= 100; ++j) {
            const Long3 direction = face.direction<Real>(Real(i) / 50 - 1, Real(j) / 50 - 1);
            const Real turning = glm::length(glm::cross(eye, direction));
            // |D0 − e·d| is least at d = D0·e/e·e, or at the end of the range.
            const Real e2 = glm::dot(eye, eye), best = e2 > 0 ? glm::dot(direction, eye) / e2 : 0;
            const Long3 seen = direction - eye * std::clamp<Real>(best, 0, 1 / nearest);
            found = std::max(found, turning / glm::dot(seen, seen));
          }
      }
    }
    worst.add(static_cast<double>(found / Real(gain)) - 1);
  }
  return worst.row("the largest turn by an error of disparity", "a finer search", "share", 0.01);
}

}  // namespace

Rows stress_projections(const Effort& effort) {
  Rows rows;
  for (const double fovy : {1.0, 60.0, 170.0}) rows.push_back(pixel_directions(fovy));
  for (const double fovy : {1.0, 60.0, 170.0}) rows.push_back(matrix_of_a_frame(fovy));
  for (const double fovy : {1.0, 60.0, 170.0}) rows.push_back(samples_to_pixels(fovy, effort));
  rows.insert(rows.end(), {samples_of_a_cell(effort), sample_grid(), box_exits(), warp_gains(effort)});
  return rows;
}

}  // namespace farfield::stability

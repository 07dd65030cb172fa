// SPDX-License-Identifier: Apache-2.0
// One face of one view: where its samples look, and what they found.
#pragma once

#include <array>
#include <vector>

#include "common/math/cube_face.h"
#include "server/impostor/cell_space.h"

namespace farfield {

/// Texture footprint of a sample as a share of its spacing. The warp interpolates between samples, which filters a second
/// time; sharpen_colours() takes most of that back, so that little needs to be saved here. Measured together with its
/// strength in streets, a plant and a hall of statues: 0.7 without sharpening, and FLIP .0446, .0288, .0201; 0.85 with 0.06
/// .0428, .0281, .0195; 1 with 0.1 .0422, .0278, .0191, but streets lose 0.2 dB. Bytes grow by 2 % in all of them.
inline constexpr double kFootprint = 0.9;

/// Sample (i, j), fractions allowed, looks along direction(i, j), whose component along the face's axis is 1: a ray's
/// parameter is then z in metres, and disparity in 1/side is side/z.
struct ViewFrame {
  CubeFace face;
  int edge_samples = 0;
  glm::dvec3 position{0};   // scene frame
  double side_m = 1;
  double pitch = 0;         // tangent units per sample

  static ViewFrame of(const CellSpace& space, const glm::dvec3& position, int face, int edge_samples) {
    return {CubeFace::of(face), edge_samples, position, space.side_m, sample_pitch(edge_samples)};
  }
  double u(double i) const { return sample_tangent(edge_samples, i); }
  glm::dvec3 direction(double i, double j) const { return face.direction(u(i), u(j)); }
  /// The mean angle a sample covers, for texture footprints: the root of its solid angle.
  float sample_angle(double i, double j) const {
    const double length = std::sqrt(1 + u(i) * u(i) + u(j) * u(j));
    return static_cast<float>(kFootprint * pitch / (length * std::sqrt(length)));
  }
};

/// What a set of rays found, [index] as its owner arranges it.
struct SampleArrays {
  std::vector<std::uint8_t> known;    // a ray was cast: covered tells what it found
  std::vector<std::uint8_t> covered;
  std::vector<float> disparity;     // 1/side
  std::vector<float> gradient_i;    // of the surface's tangent plane: disparity per sample to the right …
  std::vector<float> gradient_j;    // … and downwards
  std::vector<std::uint8_t> rgb;    // sRGB
  std::vector<std::uint32_t> part;  // of the scene; kNoHit where nothing is covered
  std::vector<std::uint8_t> refined;  // coloured from several look-ups or rays

  explicit SampleArrays(std::size_t size = 0)
      : known(size, 0), covered(size, 0), disparity(size, 0.0f), gradient_i(size, 0.0f), gradient_j(size, 0.0f), rgb(3 * size, 0), part(size, kNoHit), refined(size, 0) {}
};

/// Disparity and its gradient where lane `lane` hit. A plane n·P = c is d = side·(n·D)/c at direction D, linear in D.
struct SurfacePlane {
  float disparity, gradient_i, gradient_j;
};
inline SurfacePlane plane_at(const ViewFrame& frame, const RayPacket& rays, const HitPacket& hits, int lane) {
  const double disparity = frame.side_m / hits.distance[lane];
  const float normal[3] = {hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]};
  const double facing = double{normal[0]} * rays.direction_x[lane] + double{normal[1]} * rays.direction_y[lane] +
                        double{normal[2]} * rays.direction_z[lane];
  const double scale = disparity * frame.pitch / facing;
  const double gi = normal[frame.face.u_axis()] * scale, gj = normal[frame.face.v_axis()] * scale;
  // A surface seen exactly edge-on has no slope that could be used: call it steep.
  const auto finite = [](double g) { return static_cast<float>(std::isfinite(g) ? std::clamp(g, -1e3, 1e3) : 1e3); };
  return {static_cast<float>(disparity), finite(gi), finite(gj)};
}

/// Samples cast together, those of them at hand that see a texture at a slant: one look-up blurs across and aliases along it.
struct UnevenPacket {
  RayPacket rays;
  HitPacket hits;
  float sample_angle;
  std::array<int, kPacketSize> index;  // as of cast_samples(); -1: one look-up is enough
};

/// Casts and shades 16 samples at grid positions (i[k], j[k]) and stores what they hit at index[k] (index < 0: skipped).
/// Appends to `uneven` what shade_uneven() is worth its time for.
void cast_samples(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const int* i, const int* j,
                  const int* index, SampleArrays& out, std::vector<UnevenPacket>& uneven);

/// Shades those samples of `uneven` again that will be `kept`, from 2×2 look-ups each.
void shade_uneven(const Scene& scene, const ViewFrame& frame, const std::vector<UnevenPacket>& uneven, const std::vector<std::uint8_t>& kept,
                  SampleArrays& out);

}  // namespace farfield

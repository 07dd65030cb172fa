// SPDX-License-Identifier: Apache-2.0
// Rays in all directions from one point, in coherent packets of 4×4 grid neighbours.
#pragma once

#include <functional>
#include <limits>

#include "common/math/cube_face.h"
#include "server/scene/scene.h"

namespace farfield {

/// Solid angle of a cube-map sample at (u, v) whose tangent spacing is `pitch`, in steradians.
inline double sample_solid_angle(double u, double v, double pitch) {
  const double square = 1 + u * u + v * v;
  return pitch * pitch / (square * std::sqrt(square));
}

/// Where rays from a point may begin and end: outside `inside` (if not empty) and within `outside`.
struct RayClip {
  Box inside;   // empty: rays begin at the point
  Box outside{glm::dvec3(-std::numeric_limits<double>::infinity()), glm::dvec3(std::numeric_limits<double>::infinity())};
};

/// Sets lane `lane` to run from `origin` along `direction`, clipped. Requires: origin inside both boxes.
inline void set_ray(RayPacket& rays, int lane, const glm::dvec3& origin, const glm::dvec3& direction, const RayClip& clip) {
  rays.origin_x[lane] = static_cast<float>(origin.x);
  rays.origin_y[lane] = static_cast<float>(origin.y);
  rays.origin_z[lane] = static_cast<float>(origin.z);
  rays.direction_x[lane] = static_cast<float>(direction.x);
  rays.direction_y[lane] = static_cast<float>(direction.y);
  rays.direction_z[lane] = static_cast<float>(direction.z);
  rays.near[lane] = clip.inside.is_empty() ? 0.0f : static_cast<float>(exit_distance(clip.inside, origin, direction));
  rays.far[lane] = static_cast<float>(exit_distance(clip.outside, origin, direction));
}

/// A grid of edge×edge directions per face, at cell centres moved by `jitter` in [0, 1)². `edge` is a multiple of 4.
/// visit(rays, hits, solid_angles): solid_angles[lane] in steradians.
template <class Visit>
void cast_sphere(const Scene& scene, const glm::dvec3& origin, int edge, const glm::dvec2& jitter, const RayClip& clip,
                 Visit visit) {
  const double pitch = 2.0 / edge;
  RayPacket rays;
  HitPacket hits;
  double solid_angles[kPacketSize];
  for (int face = 0; face < kCubeFaces; ++face) {
    const CubeFace frame = CubeFace::of(face);
    for (int y = 0; y < edge; y += 4)
      for (int x = 0; x < edge; x += 4) {
        for (int lane = 0; lane < kPacketSize; ++lane) {
          const double u = -1 + (x + lane % 4 + jitter.x) * pitch, v = -1 + (y + lane / 4 + jitter.y) * pitch;
          set_ray(rays, lane, origin, frame.direction(u, v), clip);
          solid_angles[lane] = sample_solid_angle(u, v, pitch);
        }
        rays.active = 0xffff;
        scene.intersect(rays, hits);
        visit(rays, hits, solid_angles);
      }
  }
}

/// The point a lane hit, scene frame.
inline glm::dvec3 hit_point(const RayPacket& rays, const HitPacket& hits, int lane) {
  const double t = hits.distance[lane];
  return {rays.origin_x[lane] + t * rays.direction_x[lane], rays.origin_y[lane] + t * rays.direction_y[lane],
          rays.origin_z[lane] + t * rays.direction_z[lane]};
}

}  // namespace farfield

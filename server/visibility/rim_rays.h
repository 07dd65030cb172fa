// SPDX-License-Identifier: Apache-2.0
// More rays where neighbours of a packet met different surfaces: what shows through gaps narrower than rays are apart.
//
// Based on: Wonka et al. 2006, Guided Visibility Sampling (adaptive border sampling). Differs: rays are added
// between two of one viewpoint's grid instead of around the triangles that were hit.
#pragma once

#include "server/visibility/sphere_rays.h"

namespace farfield {

/// Gathers rays from one viewpoint into full packets. Not thread-safe; keeps a reference to the scene.
class RimRays {
 public:
  /// `pitch`: tangent spacing of the grid the packets are from.
  RimRays(const Scene& scene, const glm::dvec3& viewpoint, double pitch) : scene_(scene), viewpoint_(viewpoint), pitch_(static_cast<float>(pitch)) {
    rays_.active = 0;
  }

  /// Adds rays between those of a packet of 4×4 grid neighbours that met different surfaces; full packets are cast.
  /// visit(rays, hits, solid_angles) as of cast_sphere(), for the lanes of rays.active. `solid_angles`: of the packet's rays.
  template <class Visit>
  void look_between(const RayPacket& rays, const HitPacket& hits, const double* solid_angles, Visit visit) {
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (lane % 4 < 3) look_between(rays, hits, lane, lane + 1, solid_angles[lane], visit);
      if (lane < kPacketSize - 4) look_between(rays, hits, lane, lane + 4, solid_angles[lane], visit);
    }
  }
  /// Casts what has not filled a packet.
  template <class Visit>
  void finish(Visit visit) {
    if (rays_.active) cast(visit);
  }

 private:
  static constexpr int kBetween = 3;
  // Of the grid's ray beside them. Shares of what lies beside rims come out too large by it, which only sends it a little earlier.
  static constexpr double kShare = 0.25;

  template <class Visit>
  void look_between(const RayPacket& rays, const HitPacket& hits, int a, int b, double solid_angle, Visit visit) {
    if (are_one_surface(rays, hits, a, b)) return;
    for (int k = 0; k < kBetween; ++k) {
      // Multiples of the golden ratio: any three that follow each other, and all of a rim together, are spread evenly.
      const double turn = 0.6180339887498949 * static_cast<double>(++count_), place = turn - std::floor(turn);
      set_ray(rays_, lanes_, viewpoint_, glm::dvec3(glm::mix(direction(rays, a), direction(rays, b), static_cast<float>(place))), {});
      solid_angles_[lanes_] = kShare * solid_angle;
      rays_.active |= 1u << lanes_;
      if (++lanes_ == kPacketSize) cast(visit);
    }
  }
  template <class Visit>
  void cast(Visit visit) {
    HitPacket hits;
    scene_.intersect(rays_, hits);
    visit(rays_, hits, solid_angles_);
    rays_.active = 0, lanes_ = 0;
  }
  static glm::vec3 direction(const RayPacket& rays, int lane) {
    return {rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]};
  }
  // Each lies on the other's plane, or nearly: where two planes meet between the rays, they are off by up to their slope times
  // the pitch, relative to the distance. Up to a slope of two that is taken as one surface, bent.
  bool are_one_surface(const RayPacket& rays, const HitPacket& hits, int a, int b) const {
    const bool is_sky_a = hits.part[a] == kNoHit, is_sky_b = hits.part[b] == kNoHit;
    if (is_sky_a || is_sky_b) return is_sky_a && is_sky_b;
    const auto continues = [&](int from, int to) {
      const glm::vec3 normal(hits.normal_x[from], hits.normal_y[from], hits.normal_z[from]);
      const float there = hits.distance[from] * glm::dot(normal, direction(rays, from)) / glm::dot(normal, direction(rays, to));
      return std::abs(there - hits.distance[to]) <= 2 * pitch_ * hits.distance[to];
    };
    return continues(a, b) && continues(b, a);
  }

  const Scene& scene_;
  const glm::dvec3 viewpoint_;
  const float pitch_;
  RayPacket rays_;
  double solid_angles_[kPacketSize] = {};
  int lanes_ = 0;
  std::size_t count_ = 0;
};

}  // namespace farfield

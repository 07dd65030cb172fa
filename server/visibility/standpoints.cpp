// SPDX-License-Identifier: Apache-2.0
#include "server/visibility/standpoints.h"

#include "server/visibility/sphere_rays.h"

namespace farfield {

bool is_free(const Scene& scene, const glm::dvec3& point) {
  double back = 0, hit = 0;
  cast_sphere(scene, point, 8, {0.5, 0.5}, {}, [&](const RayPacket& rays, const HitPacket& hits, const double* weight) {
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (hits.part[lane] == kNoHit) continue;
      hit += weight[lane];
      const float facing = hits.normal_x[lane] * rays.direction_x[lane] + hits.normal_y[lane] * rays.direction_y[lane] +
                           hits.normal_z[lane] * rays.direction_z[lane];
      if (facing > 0) back += weight[lane];
    }
  });
  // Most of what is seen, and a quarter of the sphere at least: a few flipped triangles far away enclose nobody.
  constexpr double kSphere = 4 * 3.14159265358979323846;
  return !(back > 0.6 * hit && back > 0.25 * kSphere);
}

Standpoints find_standpoints(const Scene& scene, const Box& box) {
  Standpoints result;
  const glm::dvec3 center = box.center(), reach = (0.5 - 1.0 / 64) * box.extent();
  std::vector<glm::dvec3> lattice;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) lattice.push_back(center + glm::dvec3(x, y, z) * reach);
  for (const glm::dvec3& point : lattice)
    if (is_free(scene, point)) result.points.push_back(point);
  if (result.points.empty()) {
    result.points = std::move(lattice);
    result.all_blocked = true;
  }
  return result;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/view_frame.h"

#include "common/shading/shading.h"

namespace farfield {

void cast_samples(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const int* i, const int* j,
                  const int* index, SampleArrays& out) {
  RayPacket rays;
  HitPacket hits;
  rays.active = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    set_ray(rays, lane, frame.position, frame.direction(i[lane], j[lane]), space.shell);
    if (index[lane] >= 0) rays.active |= 1u << lane;
  }
  scene.intersect(rays, hits);
  float rgb[3 * kPacketSize];
  scene.shade(rays, hits, frame.sample_angle(0.5 * (i[0] + i[kPacketSize - 1]), 0.5 * (j[0] + j[kPacketSize - 1])), rgb);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (index[lane] < 0) continue;
    const std::size_t at = static_cast<std::size_t>(index[lane]);
    out.known[at] = 1;
    if (hits.part[lane] == kNoHit) continue;

    const SurfacePlane plane = plane_at(frame, rays, hits, lane);
    out.covered[at] = 1;
    out.disparity[at] = plane.disparity;
    out.gradient_i[at] = plane.gradient_i;
    out.gradient_j[at] = plane.gradient_j;
    for (int c = 0; c < 3; ++c) out.rgb[3 * at + c] = linear_to_srgb(rgb[3 * lane + c]);
  }
}

}  // namespace farfield

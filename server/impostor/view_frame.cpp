// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/view_frame.h"

#include <algorithm>

#include "common/shading/shading.h"

namespace farfield {
namespace {

// At a slant of more than 63 degrees a footprint is more than twice as long as wide: one look-up blurs across it and misses
// detail along it, so that little is left to differ.
constexpr float kSlantedCosine = 0.45f;
// Of 256 levels, between sixteen neighbours: where they differ less there is no detail to miss.
constexpr int kDetail = 2;

bool is_slanted(const RayPacket& rays, const HitPacket& hits, int lane) {
  const glm::vec3 normal(hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]);
  const glm::vec3 direction(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
  const float along = glm::dot(normal, direction);
  return along * along < kSlantedCosine * kSlantedCosine * glm::dot(normal, normal) * glm::dot(direction, direction);
}

bool is_textured_at_a_slant(const Scene& scene, const RayPacket& rays, const HitPacket& hits, int lane) {
  return hits.part[lane] != kNoHit && scene.is_textured(hits.part[lane]) && is_slanted(rays, hits, lane);
}

bool is_uneven(const Scene& scene, const RayPacket& rays, const HitPacket& hits, const int* index, const SampleArrays& out) {
  int low[3] = {255, 255, 255}, high[3] = {0, 0, 0};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (index[lane] < 0 || !is_textured_at_a_slant(scene, rays, hits, lane)) continue;
    for (int c = 0; c < 3; ++c) {
      const int value = out.rgb[3 * static_cast<std::size_t>(index[lane]) + c];
      low[c] = std::min(low[c], value), high[c] = std::max(high[c], value);
    }
  }
  return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}) > kDetail;
}

}  // namespace

void cast_samples(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const int* i, const int* j,
                  const int* index, SampleArrays& out, std::vector<UnevenPacket>& uneven) {
  RayPacket rays;
  HitPacket hits;
  rays.active = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    set_ray(rays, lane, frame.position, frame.direction(i[lane], j[lane]), space.shell);
    if (index[lane] >= 0) rays.active |= 1u << lane;
  }
  scene.intersect(rays, hits);
  float rgb[3 * kPacketSize];
  const float sample_angle = frame.sample_angle(0.5 * (i[0] + i[kPacketSize - 1]), 0.5 * (j[0] + j[kPacketSize - 1]));
  scene.shade(rays, hits, sample_angle, rgb);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (index[lane] < 0) continue;
    const std::size_t at = static_cast<std::size_t>(index[lane]);
    out.known[at] = 1;
    if (hits.part[lane] == kNoHit) continue;

    const SurfacePlane plane = plane_at(frame, rays, hits, lane);
    out.covered[at] = 1;
    out.part[at] = hits.part[lane];
    out.disparity[at] = plane.disparity;
    out.gradient_i[at] = plane.gradient_i;
    out.gradient_j[at] = plane.gradient_j;
    for (int c = 0; c < 3; ++c) out.rgb[3 * at + c] = linear_to_srgb(rgb[3 * lane + c]);
  }
  if (!is_uneven(scene, rays, hits, index, out)) return;
  uneven.push_back({rays, hits, sample_angle, {}});
  for (int lane = 0; lane < kPacketSize; ++lane)
    uneven.back().index[lane] = index[lane] >= 0 && is_textured_at_a_slant(scene, rays, hits, lane) ? index[lane] : -1;
}

void shade_uneven(const Scene& scene, const ViewFrame& frame, const std::vector<UnevenPacket>& uneven, const std::vector<std::uint8_t>& kept,
                  SampleArrays& out) {
  const float apart = static_cast<float>(0.5 * frame.pitch);
  const glm::vec3 origin = frame.face.direction(0.0f, 0.0f);
  const glm::vec3 across = frame.face.direction(apart, 0.0f) - origin, down = frame.face.direction(0.0f, apart) - origin;
  for (const UnevenPacket& packet : uneven) {
    RayPacket rays = packet.rays;
    rays.active = 0;
    for (int lane = 0; lane < kPacketSize; ++lane)
      if (packet.index[lane] >= 0 && kept[static_cast<std::size_t>(packet.index[lane])]) rays.active |= 1u << lane;
    if (rays.active == 0) continue;
    float rgb[3 * kPacketSize];
    scene.shade_finely(rays, packet.hits, packet.sample_angle, across, down, rgb);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (!(rays.active >> lane & 1)) continue;
      const auto at = static_cast<std::size_t>(packet.index[lane]);
      for (int c = 0; c < 3; ++c) out.rgb[3 * at + c] = linear_to_srgb(rgb[3 * lane + c]);
      out.refined[at] = 1;
    }
  }
}

}  // namespace farfield

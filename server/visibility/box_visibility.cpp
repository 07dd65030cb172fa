// SPDX-License-Identifier: Apache-2.0
#include "server/visibility/box_visibility.h"

#include "server/visibility/sphere_rays.h"
#include "server/visibility/standpoints.h"

namespace farfield {
namespace {

// The R2 sequence (Roberts 2018): successive points fill the unit square evenly, so that the viewpoints' grids interleave.
glm::dvec2 jitter_of(std::size_t index) {
  const double x = 0.5 + 0.7548776662466927 * static_cast<double>(index);
  const double y = 0.5 + 0.5698402909980532 * static_cast<double>(index);
  return {x - std::floor(x), y - std::floor(y)};
}

}  // namespace

BoxVisibility probe_visibility(const Scene& scene, const Box& viewpoints, const Box& near_box, const VisibilityProbe& probe) {
  BoxVisibility result;
  const Standpoints stand = find_standpoints(scene, viewpoints);
  result.viewpoints = stand.points.size();
  ChunkSet near(scene);
  for (std::size_t k = 0; k < stand.points.size() && !result.is_cut_short; ++k) {
    cast_sphere(scene, stand.points[k], probe.edge, jitter_of(k), {},
                [&](const RayPacket& rays, const HitPacket& hits, const double* weight) {
                  for (int lane = 0; lane < kPacketSize; ++lane) {
                    if (hits.part[lane] == kNoHit) {
                      result.escapes = true;
                      result.sky.insert({rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]});
                      continue;
                    }
                    const glm::dvec3 point = hit_point(rays, hits, lane);
                    if (near_box.contains(point)) {
                      near.insert(scene.chunk_of(hits.part[lane], hits.primitive[lane]));
                    } else {
                      result.far_hits.push_back({glm::vec3(point), static_cast<float>(weight[lane])});
                    }
                  }
                });
    result.is_cut_short = near.triangles() > probe.enough_triangles || (probe.cancel && probe.cancel->load());
  }
  // A hit just outside the near box may belong to a chunk that also reaches in, where its part inside was missed.
  if (!result.is_cut_short && probe.finds_thin_chunks) {
    std::vector<std::uint32_t> candidates;
    for (const std::uint32_t chunk : scene.chunks_in(near_box))
      if (!near.contains(chunk) && !faces_away(scene.chunks()[chunk], viewpoints)) candidates.push_back(chunk);
    add_thin_chunks(scene, candidates, stand.points, near);
    result.is_cut_short = near.triangles() > probe.enough_triangles;
  }
  result.near_chunks = near.members();
  result.near_triangles = near.triangles();
  return result;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/void_probe.h"

#include <algorithm>
#include <cmath>

#include "server/impostor/held_points.h"
#include "server/model/random_stream.h"
#include "server/visibility/standpoints.h"

namespace farfield {
namespace {

constexpr int kViewpoints = 12;
constexpr int kEdge = 24;  // rays per face edge: 3456 a viewpoint, 41 472 in all, so that 3 in 10 000 are told from none
constexpr int kTries = 3 * kViewpoints;

struct SeenPoint {
  glm::vec3 point;
};

// What is seen from `viewpoint` in the shell, one point for each ray, the rays jittered and spread nearly evenly over the
// sphere: at the tangents of even steps of angle their density varies by a fifth either way, instead of fivefold.
std::vector<SeenPoint> seen_from(const Scene& scene, const CellSpace& space, const glm::dvec3& viewpoint, RandomStream& random) {
  constexpr double kQuarter = 3.14159265358979323846 / 4;
  std::vector<SeenPoint> seen;
  for (int face = 0; face < kCubeFaces; ++face)
    for (int y = 0; y < kEdge; y += 4)
      for (int x = 0; x < kEdge; x += 4) {
        RayPacket rays;
        HitPacket hits;
        for (int lane = 0; lane < kPacketSize; ++lane) {
          const double a = -1 + 2 * (x + lane % 4 + random.unit()) / kEdge, b = -1 + 2 * (y + lane / 4 + random.unit()) / kEdge;
          set_ray(rays, lane, viewpoint, CubeFace::of(face).direction(std::tan(kQuarter * a), std::tan(kQuarter * b)), {});
        }
        scene.intersect(rays, hits);
        for (int lane = 0; lane < kPacketSize; ++lane)
          if (hits.part[lane] != kNoHit)
            if (const glm::dvec3 point = hit_point(rays, hits, lane); space.contains(point)) seen.push_back({glm::vec3(point)});
      }
  return seen;
}

}  // namespace

void VoidCount::store_in(Certificate& certificate) const {
  const auto counted = [](std::uint32_t count) { return static_cast<std::uint16_t>(std::min<std::uint32_t>(count, 0xffff)); };
  certificate.void_rays = counted(rays), certificate.void_hits = counted(hits);
  certificate.void_worst_rays = counted(worst_rays), certificate.void_worst_hits = counted(worst_hits);
}

VoidCount count_voids(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, double slack, int round,
                      const std::atomic<bool>* cancel) {
  VoidCount count;
  count.left.resize(views.size());
  RandomStream random(0x766f6964, space.cell.level, space.cell.x, space.cell.y, space.cell.z, round);
  for (int tries = 0, stood = 0; tries < kTries && stood < kViewpoints; ++tries) {
    if (cancel && cancel->load()) return {};
    const glm::dvec3 place(random.unit(), random.unit(), random.unit());
    const glm::dvec3 viewpoint = space.box.min + place * space.box.extent();
    if (!is_free(scene, viewpoint)) continue;
    ++stood;
    std::vector<SeenPoint> open = seen_from(scene, space, viewpoint, random);
    for (std::size_t view = 0; view < views.size(); ++view) {
      drop_held(scene, space, slack, PointSpacing::kSparse, views[view], open, [](const SeenPoint&) {});
      const auto left = static_cast<std::uint32_t>(open.size());
      count.left[view].hits += left, count.left[view].worst_hits = std::max(count.left[view].worst_hits, left);
    }
    constexpr std::uint32_t kRays = kCubeFaces * kEdge * kEdge;
    const auto hits = static_cast<std::uint32_t>(open.size());
    count.rays += kRays, count.hits += hits;
    if (count.worst_rays == 0 || hits > count.worst_hits) count.worst_rays = kRays, count.worst_hits = hits, count.worst = viewpoint;
  }
  return count;
}

}  // namespace farfield

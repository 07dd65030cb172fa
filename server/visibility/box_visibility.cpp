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

// Points of the box that fill it evenly and miss the lattice (R3 sequence); not all of them are free.
glm::dvec3 fresh_viewpoint(const Box& box, std::size_t index) {
  const auto place = [&](double step) { const double x = 0.5 + step * static_cast<double>(index + 1); return x - std::floor(x); };
  return box.min + box.extent() * glm::dvec3(place(0.8191725133961645), place(0.6710436067037893), place(0.5497004779019703));
}

class Probe {
 public:
  Probe(const Scene& scene, const Box& near_box, const VisibilityProbe& settings, BoxVisibility& result)
      : scene_(scene), near_box_(near_box), settings_(settings), result_(result), near_(scene) {}

  void look_from(const glm::dvec3& viewpoint) {
    cast_sphere(scene_, viewpoint, settings_.edge, jitter_of(result_.viewpoints++), {},
                [&](const RayPacket& rays, const HitPacket& hits, const double* weight) {
                  for (int lane = 0; lane < kPacketSize; ++lane) {
                    if (hits.part[lane] == kNoHit) {
                      result_.escapes = true;
                      result_.sky.insert({rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]});
                      continue;
                    }
                    const glm::dvec3 point = hit_point(rays, hits, lane);
                    if (near_box_.contains(point)) {
                      near_.insert(scene_.chunk_of(hits.part[lane], hits.primitive[lane]));
                    } else {
                      result_.far_hits.push_back({glm::vec3(point), static_cast<float>(weight[lane])});
                    }
                  }
                });
    result_.is_cut_short = near_.triangles() > settings_.enough_triangles || (settings_.cancel && settings_.cancel->load());
  }
  void converge(const Box& viewpoints) {
    constexpr int kBatches = 3, kBatch = 9, kTries = 4 * kBatches * kBatch;
    std::size_t tried = 0;
    for (int batch = 0; batch < kBatches && !result_.is_cut_short; ++batch) {
      const std::size_t before = near_.triangles();
      for (int looked = 0; looked < kBatch && tried < kTries && !result_.is_cut_short;) {
        const glm::dvec3 point = fresh_viewpoint(viewpoints, tried++);
        if (!is_free(scene_, point)) continue;
        look_from(point);
        ++looked;
      }
      result_.is_converged = near_.triangles() - before <= near_.triangles() / 100;
      if (result_.is_converged) return;
    }
  }
  ChunkSet& near() { return near_; }

 private:
  const Scene& scene_;
  const Box& near_box_;
  const VisibilityProbe& settings_;
  BoxVisibility& result_;
  ChunkSet near_;
};

}  // namespace

BoxVisibility probe_visibility(const Scene& scene, const Box& viewpoints, const Box& near_box, const VisibilityProbe& settings) {
  BoxVisibility result;
  const Standpoints stand = find_standpoints(scene, viewpoints);
  Probe probe(scene, near_box, settings, result);
  for (std::size_t k = 0; k < stand.points.size() && !result.is_cut_short; ++k) probe.look_from(stand.points[k]);
  if (settings.is_thorough && !stand.all_blocked) probe.converge(viewpoints);
  ChunkSet& near = probe.near();
  // A hit just outside the near box may belong to a chunk that also reaches in, where its part inside was missed.
  if (!result.is_cut_short && settings.is_thorough) {
    std::vector<std::uint32_t> candidates;
    for (const std::uint32_t chunk : scene.chunks_in(near_box))
      if (!near.contains(chunk) && !faces_away(scene.chunks()[chunk], viewpoints)) candidates.push_back(chunk);
    add_thin_chunks(scene, candidates, stand.points, near);
    result.is_cut_short = near.triangles() > settings.enough_triangles;
  }
  result.near_chunks = near.members();
  result.near_triangles = near.triangles();
  return result;
}

}  // namespace farfield

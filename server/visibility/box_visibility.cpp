// SPDX-License-Identifier: Apache-2.0
#include "server/visibility/box_visibility.h"

#include "server/visibility/rim_rays.h"
#include "server/visibility/sphere_rays.h"
#include "server/visibility/standpoints.h"

namespace farfield {
namespace {

// The R2 sequence (Roberts 2018): successive points fill the unit square evenly, so that the viewpoints' grids
// interleave.
glm::dvec2 jitter_of(std::size_t index) {
  const double x = 0.5 + 0.7548776662466927 * static_cast<double>(index);
  const double y = 0.5 + 0.5698402909980532 * static_cast<double>(index);
  return {x - std::floor(x), y - std::floor(y)};
}

// Points of the box that fill it evenly and miss the lattice (R3 sequence); not all of them are free.
glm::dvec3 fresh_viewpoint(const Box& box, std::size_t index) {
  const auto place = [&](double step) {
    const double x = 0.5 + step * static_cast<double>(index + 1);
    return x - std::floor(x);
  };
  return box.min +
         box.extent() * glm::dvec3(place(0.8191725133961645), place(0.6710436067037893), place(0.5497004779019703));
}

class Probe {
 public:
  Probe(const Scene& scene, const Box& viewpoints, const Box& near_box, const VisibilityProbe& settings,
        BoxVisibility& result)
      : scene_(scene),
        viewpoints_(viewpoints),
        near_box_(near_box),
        settings_(settings),
        result_(result),
        near_(scene) {}

  void divide(const std::vector<EnclosureMask>& masks) {
    result_.enclosures.resize(masks.size());
    for (std::size_t e = 0; e < masks.size(); ++e) result_.enclosures[e].mask = masks[e];
    near_of_.assign(masks.size(), ChunkSet(scene_));
  }
  /// `enclosure`: that of the viewpoint, or -1. `edge`: rays per face edge.
  void look_from(const glm::dvec3& viewpoint, int enclosure, int edge) {
    Sight here;
    ChunkSet* near_here = enclosure < 0 ? nullptr : &near_of_[enclosure];
    const auto note = [&](const RayPacket& rays, const HitPacket& hits, const double* weight) {
      for (int lane = 0; lane < kPacketSize; ++lane) {
        if (!(rays.active >> lane & 1)) continue;
        if (hits.part[lane] == kNoHit) {
          here.escapes = true;
          here.sky.insert({rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]});
          continue;
        }
        const glm::dvec3 point = hit_point(rays, hits, lane);
        if (near_box_.contains(point)) {
          const std::uint32_t chunk = scene_.chunk_of(hits.part[lane], hits.primitive[lane]);
          near_.insert(chunk);
          if (near_here) near_here->insert(chunk);
        } else {
          result_.far_hits.push_back(
              {glm::vec3(point), static_cast<float>(weight[lane]), static_cast<std::int8_t>(enclosure),
               {hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]}});
        }
      }
    };
    RimRays beside_rims(scene_, viewpoint, 2.0 / edge);
    cast_sphere(scene_, viewpoint, edge, jitter_of(result_.viewpoints), {},
                [&](const RayPacket& rays, const HitPacket& hits, const double* weight) {
                  note(rays, hits, weight);
                  if (settings_.is_thorough) beside_rims.look_between(rays, hits, weight, note);
                });
    beside_rims.finish(note);
    add(here, result_);
    if (enclosure >= 0) add(here, result_.enclosures[enclosure]);
    result_.is_cut_short =
        near_.triangles() > settings_.enough_triangles || (settings_.cancel && settings_.cancel->load());
  }
  void converge() {
    constexpr int kBatches = 3, kBatch = 9;
    for (int batch = 0; batch < kBatches && !result_.is_cut_short; ++batch) {
      const std::size_t before = near_.triangles();
      for (int looked = 0; looked < kBatch && !result_.is_cut_short; ++looked)
        if (!look_from_fresh([](int) { return true; }, 4 * kBatches * kBatch, settings_.edge)) break;
      result_.is_converged = near_.triangles() - before <= near_.triangles() / 100;
      if (result_.is_converged) return;
    }
  }
  /// Many viewpoints of few rays each: what shows only through a gap, from between the heights of the lattice, is seen
  /// from some of them.
  void look_through_gaps() {
    constexpr int kGlances = 108;
    const int edge = std::max(4, settings_.edge / 2 / 4 * 4);
    for (int k = 0; k < kGlances && !result_.is_cut_short; ++k)
      if (!look_from_fresh([](int) { return true; }, tried_ + 4 * kGlances, edge)) return;
  }
  /// More viewpoints for enclosures that few fell into.
  void look_around_enclosures() {
    const std::size_t tries = tried_ + 512;
    const auto is_wanting = [&](int e) { return e >= 0 && result_.enclosures[e].viewpoints < kEnclosureViewpoints; };
    while (!result_.is_cut_short && look_from_fresh(is_wanting, tries, settings_.edge)) {
    }
  }
  /// Inserts what is thin among the candidates and was met by no ray yet. `standpoints`: with the enclosure of each.
  void add_thin(const std::vector<std::uint32_t>& candidates, const std::vector<glm::dvec3>& standpoints,
                const std::vector<int>& enclosure_of) {
    for (int e = -1; e < static_cast<int>(near_of_.size()); ++e) {
      std::vector<glm::dvec3> here;
      for (std::size_t k = 0; k < standpoints.size(); ++k)
        if (enclosure_of[k] == e) here.push_back(standpoints[k]);
      if (e < 0) {
        add_thin_chunks(scene_, candidates, here, near_);
        continue;
      }
      add_thin_chunks(scene_, candidates, here, near_of_[e]);
      for (const std::uint32_t chunk : near_of_[e].members()) near_.insert(chunk);
    }
  }
  void finish() {
    const auto note = [](const ChunkSet& near, Sight& sight) {
      sight.near_chunks = near.members();
      sight.near_triangles = near.triangles();
    };
    note(near_, result_);
    for (std::size_t e = 0; e < near_of_.size(); ++e) note(near_of_[e], result_.enclosures[e]);
  }
  const ChunkSet& near() const { return near_; }

 private:
  static void add(const Sight& from_one, Sight& sight) {
    ++sight.viewpoints;
    sight.escapes |= from_one.escapes;
    sight.sky.insert(from_one.sky);
  }
  int enclosure_at(const glm::dvec3& point) const {
    for (std::size_t e = 0; e < result_.enclosures.size(); ++e)
      if (result_.enclosures[e].mask.contains(viewpoints_, point)) return static_cast<int>(e);
    return -1;
  }
  /// Looks from the next free place of the sequence whose enclosure is wanted. Returns: false if none of the first
  /// `tries` is left.
  template <class IsWanted>
  bool look_from_fresh(IsWanted is_wanted, std::size_t tries, int edge) {
    while (tried_ < tries) {
      const glm::dvec3 point = fresh_viewpoint(viewpoints_, tried_++);
      const int enclosure = enclosure_at(point);
      if (!is_wanted(enclosure) || !is_free(scene_, point)) continue;
      look_from(point, enclosure, edge);
      return true;
    }
    return false;
  }

  const Scene& scene_;
  const Box viewpoints_, near_box_;
  const VisibilityProbe& settings_;
  BoxVisibility& result_;
  ChunkSet near_;
  std::vector<ChunkSet> near_of_;  // by enclosure
  std::size_t tried_ = 0;          // of the sequence of fresh viewpoints
};

}  // namespace

BoxVisibility probe_visibility(const Scene& scene, const Box& viewpoints, const Box& near_box,
                               const VisibilityProbe& settings) {
  BoxVisibility result;
  Standpoints stand = find_standpoints(scene, viewpoints);
  result.is_blocked = stand.all_blocked;
  Probe probe(scene, viewpoints, near_box, settings, result);
  std::vector<int> enclosure_of(stand.points.size(), -1);
  const bool is_thorough = settings.is_thorough && !stand.all_blocked;
  if (is_thorough) {
    Enclosures enclosures = find_enclosures(scene, viewpoints, stand.points, settings.enclosure_voxel_m);
    stand.points = std::move(enclosures.viewpoints);
    enclosure_of = std::move(enclosures.of_viewpoint);
    probe.divide(enclosures.masks);
  }
  for (std::size_t k = 0; k < stand.points.size() && !result.is_cut_short; ++k)
    probe.look_from(stand.points[k], enclosure_of[k], settings.edge);
  if (is_thorough) {
    probe.converge();
    probe.look_through_gaps();
    probe.look_around_enclosures();
  }
  // A hit just outside the near box may belong to a chunk that also reaches in, where its part inside was missed.
  if (!result.is_cut_short && settings.is_thorough) {
    std::vector<std::uint32_t> candidates;
    for (const std::uint32_t chunk : scene.chunks_in(near_box))
      if (!faces_away(scene.chunks()[chunk], viewpoints)) candidates.push_back(chunk);
    probe.add_thin(candidates, stand.points, enclosure_of);
    result.is_cut_short = probe.near().triangles() > settings.enough_triangles;
  }
  probe.finish();
  return result;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Where a person can stand: random places, dropped to the floor, judged by rays.
#include <cmath>

#include "server/app/body_probe.h"
#include "server/app/walk_path.h"
#include "server/model/random_stream.h"

namespace farfield {
namespace {

constexpr int kMostTries = 6000, kEnoughCandidates = 32;
constexpr double kRoofReach = 6;  // metres: what is covered within them is indoors

struct Choice {
  glm::dvec3 eye{0};
  double score = -1;
  int count = 0;

  void consider(const glm::dvec3& candidate, double candidate_score) {
    ++count;
    if (candidate_score > score) score = candidate_score, eye = candidate;
  }
};

// How far the floor reaches: the share of places about the point that lie at its height.
double floor_share(const BodyProbe& probe, const glm::dvec3& floor) {
  int level = 0, all = 0;
  for (const double distance : {1.5, 4.0, 8.0}) {
    for (int k = 0; k < 8; ++k, ++all) {
      const double angle = 0.785398 * (k + 0.5);
      const glm::dvec3 from = floor + probe.scale() * glm::dvec3(distance * std::cos(angle), 1.0, distance * std::sin(angle));
      const std::optional<double> there = probe.floor_below(from, 1.6 * probe.scale());
      level += there && std::abs(*there - floor.y) < 0.6 * probe.scale();
    }
  }
  return static_cast<double>(level) / all;
}

}  // namespace

Result<glm::dvec3> standing_point(const Scene& scene, std::uint64_t seed) {
  const Box& bounds = scene.bounds();
  const BodyProbe probe(scene, BodyProbe::scale_for(scene));
  RandomStream random(seed, 71);
  const double height = bounds.extent().y + probe.scale(), s = probe.scale();
  // Some models are turned inside out: if nothing passes the test of back sides, a second round goes without it.
  for (const bool trusts_normals : {true, false}) {
    // The best place of the commoner kind: indoors in a building, outdoors in a town.
    Choice indoors, outdoors;
    for (int n = 0; n < kMostTries && indoors.count + outdoors.count < kEnoughCandidates; ++n) {
      // Middle places first: the edges of a model see least of it.
      const double spread = n < kMostTries / 2 ? 0.7 : 1.0;
      const glm::dvec3 offset(spread * random.between(-0.5, 0.5), 0, spread * random.between(-0.5, 0.5));
      glm::dvec3 from = bounds.center() + offset * bounds.extent();
      // Low starts are likelier: streets before roofs.
      const double up = random.unit();
      from.y = bounds.min.y + height * up * up + 0.1 * s;
      const std::optional<double> floor_y = probe.floor_below(from, 2 * height);
      if (!floor_y) continue;
      const glm::dvec3 floor(from.x, *floor_y, from.z), eye = floor + glm::dvec3(0, probe.eye_height_m(), 0);
      if (!probe.has_room_to_stand(floor)) continue;
      const BodyProbe::Outlook outlook = probe.look_around(eye);
      if (outlook.near_share > 0.5 || outlook.level_hit_share < 0.08) continue;
      if (trusts_normals && outlook.hit_share > 0.4 && outlook.back_share > 0.6) continue;
      const double low = std::exp(-(floor.y - bounds.min.y) / (12 * s));
      const double open = std::min(outlook.median_level_m / (15 * s), 1.0);
      const double score = (0.3 + 0.7 * low) * (0.2 + open) * (0.2 + outlook.level_hit_share) * (0.1 + floor_share(probe, floor));
      const bool is_covered = probe.free_distance(eye, {0, 1, 0}, kRoofReach * s) < kRoofReach * s;
      (is_covered ? indoors : outdoors).consider(eye, score);
    }
    if (indoors.count + outdoors.count > 0) return indoors.count >= outdoors.count ? indoors.eye : outdoors.eye;
  }
  return fail(ErrorCode::kNotFound, "{}: no place to stand found (a floor with 2 m of head room and 0.8 m of width)", scene.name());
}

}  // namespace farfield

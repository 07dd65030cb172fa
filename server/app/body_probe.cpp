// SPDX-License-Identifier: Apache-2.0
#include "server/app/body_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace farfield {
namespace {

constexpr double kTau = 6.283185307179586;
constexpr double kGoldenAngle = 2.399963229728653;
constexpr int kOutlookRays = 128;

void set_lane(RayPacket& packet, int lane, const glm::dvec3& origin, const glm::dvec3& direction, double reach) {
  packet.origin_x[lane] = static_cast<float>(origin.x);
  packet.origin_y[lane] = static_cast<float>(origin.y);
  packet.origin_z[lane] = static_cast<float>(origin.z);
  packet.direction_x[lane] = static_cast<float>(direction.x);
  packet.direction_y[lane] = static_cast<float>(direction.y);
  packet.direction_z[lane] = static_cast<float>(direction.z);
  packet.near[lane] = 0;
  packet.far[lane] = static_cast<float>(reach);
}

/// Evenly spread directions (a spiral of `count` points on the sphere).
glm::dvec3 sphere_direction(int index, int count) {
  const double y = 1 - (2.0 * index + 1) / count, r = std::sqrt(1 - y * y), angle = kGoldenAngle * index;
  return {r * std::cos(angle), y, r * std::sin(angle)};
}

// Rays in any number, cast sixteen at a time; stops at the first packet that meets something.
class OcclusionBatch {
 public:
  explicit OcclusionBatch(const Scene& scene) : scene_(scene) {}
  void add(const glm::dvec3& origin, const glm::dvec3& direction, double reach) {
    if (is_blocked_) return;
    set_lane(packet_, count_++, origin, direction, reach);
    if (count_ == kPacketSize) cast();
  }
  bool is_blocked() {
    cast();
    return is_blocked_;
  }

 private:
  void cast() {
    if (count_ == 0 || is_blocked_) return;
    for (int lane = count_; lane < kPacketSize; ++lane) set_lane(packet_, lane, {}, {0, 1, 0}, 0);
    packet_.active = (1u << count_) - 1;
    is_blocked_ = (scene_.occluded(packet_) & packet_.active) != 0;
    count_ = 0;
  }
  const Scene& scene_;
  RayPacket packet_{};
  int count_ = 0;
  bool is_blocked_ = false;
};

}  // namespace

double BodyProbe::scale_for(const Scene& scene) {
  const glm::dvec3 extent = scene.bounds().extent();
  return std::min(1.0, std::max({extent.x, extent.y, extent.z}) / 10.0);
}

double BodyProbe::free_distance(const glm::dvec3& from, const glm::dvec3& direction, double reach_m) const {
  RayPacket rays{};
  HitPacket hits{};
  set_lane(rays, 0, from, direction, reach_m);
  rays.active = 1;
  scene_.intersect_scattered(rays, hits);
  return hits.part[0] == kNoHit ? reach_m : std::min<double>(hits.distance[0], reach_m);
}

std::optional<double> BodyProbe::floor_below(const glm::dvec3& from, double reach_m) const {
  RayPacket rays{};
  HitPacket hits{};
  set_lane(rays, 0, from, {0, -1, 0}, reach_m);
  rays.active = 1;
  scene_.intersect_scattered(rays, hits);
  if (hits.part[0] == kNoHit) return std::nullopt;
  const glm::dvec3 normal(hits.normal_x[0], hits.normal_y[0], hits.normal_z[0]);
  if (std::abs(normal.y) < 0.7 * glm::length(normal)) return std::nullopt;
  return from.y - hits.distance[0];
}

bool BodyProbe::has_room_to_stand(const glm::dvec3& floor_point) const {
  OcclusionBatch batch(scene_);
  const double radius = clearance_m();
  const glm::dvec3 eye = floor_point + glm::dvec3(0, eye_height_m(), 0);
  constexpr int kRing = 16;
  std::array<glm::dvec3, kRing> ring;
  for (int k = 0; k < kRing; ++k) ring[static_cast<std::size_t>(k)] = {std::cos(kTau * k / kRing), 0, std::sin(kTau * k / kRing)};
  for (const double height : {1.0, 0.8, 0.53, 0.22}) {  // of the eye: eye, chest, waist, knee
    const glm::dvec3 at = floor_point + glm::dvec3(0, height * eye_height_m(), 0);
    for (const glm::dvec3& out : ring) batch.add(at, out, radius);
    for (int k = 0; k < kRing; ++k) {  // chords between the rays' ends
      const glm::dvec3 from = at + radius * ring[static_cast<std::size_t>(k)], to = at + radius * ring[static_cast<std::size_t>((k + 1) % kRing)];
      batch.add(from, to - from, 1);
    }
    if (batch.is_blocked()) return false;
  }
  for (const glm::dvec3& out : ring) {
    batch.add(eye, glm::normalize(out + glm::dvec3(0, 0.9, 0)), radius);
    batch.add(eye, glm::normalize(out - glm::dvec3(0, 0.9, 0)), radius);
    // Uprights on the rim, from the knee to above the head: catch beams and table tops between the rings.
    batch.add(floor_point + 0.8 * radius * out + glm::dvec3(0, 0.22 * eye_height_m(), 0), {0, 1, 0}, 0.98 * eye_height_m());
  }
  batch.add(floor_point + glm::dvec3(0, 0.22 * eye_height_m(), 0), {0, 1, 0}, 0.98 * eye_height_m());
  return !batch.is_blocked();
}

bool BodyProbe::has_room_to_float(const glm::dvec3& center, double radius_m) const {
  OcclusionBatch batch(scene_);
  constexpr int kRays = 48;
  for (int k = 0; k < kRays; ++k) batch.add(center, sphere_direction(k, kRays), radius_m);
  return !batch.is_blocked();
}

BodyProbe::Outlook BodyProbe::look_around(const glm::dvec3& eye) const {
  const double far = 2 * glm::length(scene_.bounds().extent()) + scale_, level_limit = 60 * scale_;
  Outlook outlook;
  int hits = 0, near = 0, back = 0, level = 0, level_hits = 0;
  std::vector<double> level_distances;
  for (int first = 0; first < kOutlookRays; first += kPacketSize) {
    RayPacket rays{};
    HitPacket found{};
    for (int lane = 0; lane < kPacketSize; ++lane) set_lane(rays, lane, eye, sphere_direction(first + lane, kOutlookRays), far);
    rays.active = 0xffff;
    scene_.intersect_scattered(rays, found);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const bool is_hit = found.part[lane] != kNoHit;
      const double distance = is_hit ? found.distance[lane] : far;
      hits += is_hit;
      near += is_hit && distance < 0.5 * scale_;
      const float facing = found.normal_x[lane] * rays.direction_x[lane] + found.normal_y[lane] * rays.direction_y[lane] + found.normal_z[lane] * rays.direction_z[lane];
      back += is_hit && facing > 0;
      if (std::abs(rays.direction_y[lane]) > 0.3f) continue;
      ++level;
      level_hits += is_hit && distance > scale_ && distance < level_limit;
      level_distances.push_back(std::min(distance, level_limit));
    }
  }
  outlook.hit_share = static_cast<double>(hits) / kOutlookRays;
  outlook.near_share = static_cast<double>(near) / kOutlookRays;
  outlook.back_share = hits > 0 ? static_cast<double>(back) / hits : 0;
  outlook.level_hit_share = static_cast<double>(level_hits) / std::max(level, 1);
  const auto middle = level_distances.begin() + static_cast<std::ptrdiff_t>(level_distances.size() / 2);
  std::nth_element(level_distances.begin(), middle, level_distances.end());
  outlook.median_level_m = *middle;
  return outlook;
}

bool BodyProbe::is_inside_solid(const glm::dvec3& eye) const {
  const Outlook outlook = look_around(eye);
  return outlook.near_share > 0.8 || (outlook.hit_share > 0.9 && outlook.back_share > 0.7);
}

}  // namespace farfield

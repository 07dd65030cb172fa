// SPDX-License-Identifier: Apache-2.0
// Closed meshes from inside: no ray may get out, wherever it is aimed.
//
// Embree is built here with RTC_SCENE_FLAG_ROBUST. Its test of a triangle then looks at the signs of three edge functions
// (Plücker coordinates); of an edge that two triangles share both compute the same number, negated, so that no ray passes
// between them. At a vertex that is not enough: all its edge functions vanish there, and what is left of them is rounding,
// whose signs may contradict each other. How near that is: an edge e = v2 − v0 of points v relative to the eye gives
// U = D·(e × (v0 + v2)), for a ray that passes it at a distance of s, U = 2s|e||D|. After the v, which all triangles round
// alike, seven roundings follow (difference 1, sum 1, products and differences of the cross product 2, dot product 3) of
// terms up to 2r|e||D|, r the distance: U is noise for s < 7u·r, u = 2^-24, or 2^-21 r. An edge seen aslant turns noisy
// earlier, so the suite asks at 2^-18 r: a four-hundredth of a pixel at 720p and 60 degrees.
// At the vertex itself a ray slips out where all edges of its fan happen to have one sign: of k independent signs
// 2^(1 − k), 1/32 for the usual fan of six. Nothing in Farfield aims rays at vertices. By chance a ray comes within 2^-21 r of
// a given one with a probability of 2^-44: with 10^5 of them in sight fewer than one ray in 10^9 slips out.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <bit>
#include <mutex>

#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"
#include "tests/unit/server/scene/scene_models.h"

namespace farfield::stability {
namespace {

struct ClosedMesh {
  const char* name;
  std::shared_ptr<const Scene> scene;
  std::vector<glm::vec3> corners;  // of the triangles as they are cast, scene frame, three each
};

ClosedMesh closed(const char* name, Model model) {
  ClosedMesh mesh{name, build_scene(std::move(model)), {}};
  for (std::uint32_t c = 0; c < mesh.scene->chunks().size(); ++c) {
    const Chunk chunk = mesh.scene->chunk_geometry(c);
    const glm::vec3 at(mesh.scene->chunks()[c].scene_from_chunk[3]);
    for (const std::uint16_t index : chunk.indices) mesh.corners.push_back(chunk.vertices[index].position + at);
  }
  return mesh;
}

// A sphere whose points are moved in and out: slanted triangles, fans of six, no two edges alike.
Mesh rough_sphere(int rings) {
  Mesh mesh = test::sphere(rings);
  for (glm::vec3& p : mesh.positions) p *= 1.0f + 0.03f * std::sin(17.0f * p.x + 23.0f * p.y) * std::cos(19.0f * p.z);
  return mesh;
}

enum class Target { kAnywhere, kEdge, kBesideVertex, kVertex };

struct Leaks {
  std::uint64_t rays = 0, leaks = 0;
};

// Rays from within three tenths of the mesh's size of its centre, where all of these meshes see all of themselves.
Leaks count_leaks(const ClosedMesh& mesh, Target target, std::uint64_t rays_wanted) {
  constexpr std::uint64_t kBlock = 1 << 12;  // packets, each cast as coherent rays, as scattered rays and for occlusion
  constexpr std::uint64_t kBlockRays = 3 * kPacketSize * kBlock;
  const std::uint64_t blocks = (rays_wanted + kBlockRays - 1) / kBlockRays;
  const glm::vec3 centre(mesh.scene->bounds().center()), half(0.5 * mesh.scene->bounds().extent());
  std::atomic<std::uint64_t> leaks{0};
  tbb::parallel_for(std::uint64_t{0}, blocks, [&](std::uint64_t block) {
    std::mt19937 random(static_cast<unsigned>(block * 4 + static_cast<unsigned>(target)));
    std::uniform_real_distribution<float> unit(0, 1), signed_unit(-1, 1);
    const auto point = [&] { return glm::vec3(signed_unit(random), signed_unit(random), signed_unit(random)); };
    std::uint64_t lost = 0;
    for (std::uint64_t k = 0; k < kBlock; ++k) {
      const glm::vec3 eye = centre + 0.3f * half * point();
      RayPacket rays = test::packet_from(eye);
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const glm::vec3* p = &mesh.corners[3 * (random() % (mesh.corners.size() / 3))];
        const int corner = static_cast<int>(random() % 3);
        glm::vec3 aim = centre + half * point();
        if (target == Target::kEdge) aim = p[corner] + unit(random) * (p[(corner + 1) % 3] - p[corner]);
        if (target == Target::kVertex || target == Target::kBesideVertex) aim = p[corner];
        if (target == Target::kBesideVertex) aim += 0x1p-18f * glm::length(aim - eye) * glm::normalize(glm::cross(aim - eye, point()));
        test::aim(rays, lane, aim - eye);
      }
      HitPacket hits;
      mesh.scene->intersect(rays, hits);
      for (int lane = 0; lane < kPacketSize; ++lane) lost += hits.part[lane] == kNoHit;
      mesh.scene->intersect_scattered(rays, hits);
      for (int lane = 0; lane < kPacketSize; ++lane) lost += hits.part[lane] == kNoHit;
      lost += static_cast<std::uint64_t>(kPacketSize - std::popcount(mesh.scene->occluded(rays)));
    }
    leaks += lost;
  });
  return {blocks * kBlockRays, leaks};
}

}  // namespace

Rows stress_leaks(const Effort& effort) {
  std::vector<ClosedMesh> meshes;
  meshes.push_back(closed("a sphere", test::model_of(test::sphere(40))));
  meshes.push_back(closed("a rough sphere", test::model_of(rough_sphere(120))));
  meshes.push_back(closed("a room", room_model(kHall, 9)));
  meshes.push_back(closed("a room of 12 triangles", room_model(kHall, 1)));
  Rows rows;
  const auto add = [&](Target target, const char* input, double share, double bound, const char* unit) {
    Leaks all;
    for (const ClosedMesh& mesh : meshes) {
      const Leaks leaks = count_leaks(
          mesh, target, static_cast<std::uint64_t>(share * static_cast<double>(effort.leak_rays) / static_cast<double>(meshes.size())));
      all.rays += leaks.rays, all.leaks += leaks.leaks;
    }
    WorstError worst;
    worst.count(all.leaks, all.rays);
    StressRow row = worst.row(input, "a hit", unit, bound);
    if (target == Target::kVertex) row.worst /= static_cast<double>(all.rays);
    rows.push_back(row);
  };
  add(Target::kAnywhere, "rays anywhere, from inside closed meshes", 0.3, 0, "leaks");
  add(Target::kEdge, "rays at points of edges", 0.4, 0, "leaks");
  add(Target::kBesideVertex, "rays past vertices, 2^-18 of their distance beside them", 0.25, 0, "leaks");
  add(Target::kVertex, "rays at vertices", 0.05, 0x1p-5, "share of leaks");
  return rows;
}

}  // namespace farfield::stability

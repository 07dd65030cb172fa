// SPDX-License-Identifier: Apache-2.0
// Rays against references: brute force, flattened copies of instances, closed surfaces, masks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/server/scene/scene_models.h"

namespace farfield {
namespace {

using namespace test;

// Möller & Trumbore 1997 in long double.
long double ray_triangle(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3 corner[3]) {
  using V = glm::vec<3, long double>;
  const V o(origin), d(direction), a(corner[0]), e1 = V(corner[1]) - a, e2 = V(corner[2]) - a;
  const V p = glm::cross(d, e2);
  const long double det = glm::dot(e1, p);
  if (det == 0) return INFINITY;
  const V s = o - a;
  const long double u = glm::dot(s, p) / det;
  const V q = glm::cross(s, e1);
  const long double v = glm::dot(d, q) / det;
  const long double t = glm::dot(e2, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 ? t : static_cast<long double>(INFINITY);
}

std::vector<glm::dvec3> drawn_corners(const Scene& scene) {
  std::vector<glm::dvec3> corners;
  for (std::uint32_t c = 0; c < scene.chunks().size(); ++c) {
    const Chunk chunk = scene.chunk_geometry(c);
    for (const std::uint16_t index : chunk.indices)
      corners.push_back(scene.chunks()[c].scene_from_chunk * glm::dvec4(chunk.vertices[index].position, 1));
  }
  return corners;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  glm::vec3 point(float low, float high) { return {value(low, high), value(low, high), value(low, high)}; }
  float value(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine_); }

 private:
  std::mt19937 engine_;
};

TEST(Intersect, AgreesWithBruteForceOverTheChunksThatClientsDraw) {
  const auto scene = build(model_of(random_triangles(1500, 7)));
  const std::vector<glm::dvec3> corners = drawn_corners(*scene);
  ASSERT_EQ(corners.size(), 4500u);
  Random random(1);
  int hit_count = 0;
  for (int round = 0; round < 40; ++round) {
    const glm::vec3 eye = random.point(-1, 5);
    RayPacket rays = packet_from(eye);
    for (int i = 0; i < kPacketSize; ++i) aim(rays, i, random.point(0, 4) - eye);
    rays.active = 0xfff7;
    HitPacket hits;
    round % 2 ? scene->intersect(rays, hits) : scene->intersect_scattered(rays, hits);
    const std::uint32_t occluded = scene->occluded(rays);
    EXPECT_EQ(scene->occluded_coherent(rays), occluded);
    EXPECT_EQ(hits.part[3], kNoHit) << "an inactive lane";
    EXPECT_EQ(occluded >> 3 & 1, 0u);
    for (int i = 0; i < kPacketSize; ++i) {
      if (i == 3) continue;
      long double nearest = INFINITY;
      std::size_t which = 0;
      const glm::dvec3 direction(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]);
      for (std::size_t t = 0; t < corners.size(); t += 3) {
        const long double at = ray_triangle(eye, direction, &corners[t]);
        if (at < nearest) nearest = at, which = t;
      }
      EXPECT_EQ(std::isfinite(nearest), hits.part[i] != kNoHit);
      EXPECT_EQ(std::isfinite(nearest), (occluded >> i & 1) != 0);
      if (!std::isfinite(nearest) || hits.part[i] == kNoHit) continue;
      ++hit_count;
      EXPECT_NEAR(hits.distance[i], static_cast<double>(nearest), 2e-5 * static_cast<double>(nearest) + 1e-6);
      EXPECT_EQ(hits.primitive[i], which / 3) << "flattened triangles are numbered in chunk order";
      const glm::dvec3 normal = glm::cross(corners[which + 1] - corners[which], corners[which + 2] - corners[which]);
      const glm::dvec3 found(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
      EXPECT_LT(glm::length(found - normal), 1e-4 * glm::length(normal) + 1e-7) << "direction and length";
    }
  }
  EXPECT_GT(hit_count, 100);
}

TEST(Intersect, FarLimitsTheRayAndNearStartsIt) {
  const auto scene = build(model_of(square()));
  const glm::vec3 in_front(0.5f, 0.4f, 2.0f);
  RayPacket rays = packet_from(in_front);
  for (int i = 0; i < kPacketSize; ++i) aim(rays, i, {0, 0, -1});
  rays.far[1] = 1.9f;
  rays.near[2] = 2.1f;
  rays.near[3] = 5, rays.far[3] = 1;
  HitPacket hits;
  scene->intersect(rays, hits);
  EXPECT_FLOAT_EQ(hits.distance[0], 2.0f);
  EXPECT_EQ(hits.part[1], kNoHit);
  EXPECT_EQ(hits.distance[1], 1.9f);
  EXPECT_EQ(hits.part[2], kNoHit);
  EXPECT_EQ(hits.part[3], kNoHit);
  EXPECT_EQ(scene->occluded(rays), 0xfff1u);
  EXPECT_EQ(scene->occluded_coherent(rays), 0xfff1u);
}

TEST(Intersect, AnEyeOnASurfaceSeesPastIt) {
  Model model = model_of(square());
  model.instances.push_back({0, glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 2))});
  model.instances.push_back({0, glm::translate(glm::dmat4(1), glm::dvec3(0, 0, -3))});
  const auto scene = build(std::move(model));
  RayPacket rays = packet_from(glm::vec3(-scene->origin()) + glm::vec3(0.5f, 0.375f, 0));
  for (int i = 0; i < kPacketSize; ++i) aim(rays, i, {0.01f * static_cast<float>(i), 0, i % 2 ? 1.0f : -1.0f});
  HitPacket hits;
  for (const bool is_scattered : {false, true}) {
    is_scattered ? scene->intersect_scattered(rays, hits) : scene->intersect(rays, hits);
    for (int i = 0; i < kPacketSize; ++i) EXPECT_FLOAT_EQ(hits.distance[i], i % 2 ? 2.0f : 3.0f) << "lane " << i;
  }
  for (int i = 0; i < kPacketSize; ++i) rays.far[i] = 1.5f;
  EXPECT_EQ(scene->occluded(rays), 0u);
  EXPECT_EQ(scene->occluded_coherent(rays), 0u);
}

TEST(Intersect, InstancesEqualTheirFlattenedCopies) {
  const Mesh mesh = random_triangles(1200, 3);
  glm::dmat4 mirrored = glm::translate(glm::dmat4(1), glm::dvec3(9, 0, 2));
  mirrored = glm::rotate(mirrored, 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  mirrored = glm::scale(mirrored, glm::dvec3(-1.5, 0.5, 2));
  const glm::dmat4 shifted = glm::translate(glm::dmat4(1), glm::dvec3(0, 5, 0));
  Model instanced = model_of(mesh, shifted);
  instanced.instances.push_back({0, mirrored});
  Model copied = model_of(mesh, shifted);
  copied.meshes.push_back(mesh);
  copied.instances.push_back({1, mirrored});
  const auto a = build(std::move(instanced)), b = build(std::move(copied));
  ASSERT_EQ(a->parts().size(), 2u);
  ASSERT_EQ(b->parts().size(), 1u);
  EXPECT_EQ(a->statistics().stored_triangles, 1200u);
  EXPECT_EQ(a->statistics().drawn_triangles, 2400u);
  ASSERT_EQ(a->origin(), b->origin());

  Random random(5);
  int same = 0, hit = 0;
  for (int round = 0; round < 400; ++round) {
    const glm::vec3 eye = glm::vec3(b->bounds().min) + random.point(0, 1) * glm::vec3(b->bounds().extent());
    const glm::vec3 target = glm::vec3(b->bounds().min) + random.point(0, 1) * glm::vec3(b->bounds().extent());
    RayPacket rays = packet_from(eye);
    for (int i = 0; i < kPacketSize; ++i) aim(rays, i, target - eye + random.point(-0.5f, 0.5f));
    HitPacket hits_a, hits_b;
    a->intersect(rays, hits_a);
    b->intersect(rays, hits_b);
    float rgb_a[3 * kPacketSize] = {}, rgb_b[3 * kPacketSize] = {};
    a->shade(rays, hits_a, 0.001f, rgb_a);
    b->shade(rays, hits_b, 0.001f, rgb_b);
    for (int i = 0; i < kPacketSize; ++i) {
      if (hits_b.part[i] == kNoHit) continue;
      ++hit;
      // The two grids differ, so a ray along an edge may meet different triangles: rare, and counted.
      if (hits_a.part[i] == kNoHit || std::abs(hits_a.distance[i] - hits_b.distance[i]) > 1e-4f) continue;
      ++same;
      const glm::vec3 na(hits_a.normal_x[i], hits_a.normal_y[i], hits_a.normal_z[i]);
      const glm::vec3 nb(hits_b.normal_x[i], hits_b.normal_y[i], hits_b.normal_z[i]);
      EXPECT_LT(glm::length(na - nb), 2e-3f * glm::length(nb) + 1e-6f);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb_a[3 * i + c], rgb_b[3 * i + c], 2e-3f);
    }
  }
  EXPECT_GT(hit, 300);
  EXPECT_GE(same, hit * 99 / 100);
}

// Where all edges meet the ray at once, at a vertex, Embree's edge tests may round to contradicting signs: measured,
// 2.4 in 1,000 rays aimed at the very vertices of a fine sphere slip through. Along edges none may.
TEST(Intersect, NoRayLeavesAClosedSphereOrBox) {
  Mesh box;
  const glm::vec3 c[8] = {{-3, -3, -3}, {3, -3, -3}, {-3, 3, -3}, {3, 3, -3},
                          {-3, -3, 3},  {3, -3, 3},  {-3, 3, 3},  {3, 3, 3}};
  box.positions.assign(c, c + 8);
  box.indices = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};
  for (const Mesh& mesh : {sphere(40), box}) {
    const auto scene = build(model_of(mesh));
    const Scene& s = *scene;
    const glm::vec3 centre(s.bounds().center());
    Random random(2);
    std::size_t leaks = 0, rays_cast = 0, vertex_leaks = 0, vertex_rays = 0;
    const auto fire = [&](const glm::vec3& eye, std::size_t& leak_count, std::size_t& ray_count,
                          const auto& target_of) {
      RayPacket rays = packet_from(eye);
      for (int i = 0; i < kPacketSize; ++i) aim(rays, i, target_of(i) - eye);
      HitPacket hits;
      s.intersect(rays, hits);
      for (int i = 0; i < kPacketSize; ++i) leak_count += hits.part[i] == kNoHit;
      leak_count += static_cast<std::size_t>(kPacketSize - std::popcount(s.occluded(rays)));
      ray_count += 2 * kPacketSize;
    };
    for (std::uint32_t chunk = 0; chunk < s.chunks().size(); ++chunk) {
      const Chunk geometry = s.chunk_geometry(chunk);
      const glm::vec3 shift(s.chunks()[chunk].scene_from_chunk[3]);
      for (std::size_t t = 0; t < geometry.indices.size(); t += 3) {
        glm::vec3 p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = geometry.vertices[geometry.indices[t + k]].position + shift;
        const auto on_edge = [&](int i) {
          const float along = (static_cast<float>(i / 3) + 1.0f) / 7.0f;
          return p[i % 3] + along * (p[(i + 1) % 3] - p[i % 3]);
        };
        fire(centre + 0.3f * random.point(-1, 1), leaks, rays_cast, on_edge);
        fire(centre + 0.3f * random.point(-1, 1), vertex_leaks, vertex_rays, [&](int i) { return p[i % 3]; });
      }
    }
    while (rays_cast < 1000000)
      fire(centre + 0.3f * random.point(-1, 1), leaks, rays_cast, [&](int) { return centre + random.point(-1, 1); });
    EXPECT_EQ(leaks, 0u);
    EXPECT_LE(vertex_leaks * 250, vertex_rays) << vertex_leaks << " of " << vertex_rays;
  }
}

TEST(Intersect, AlphaMaskLetsRaysThroughItsHoles) {
  Model model = model_of(square());
  TextureImage image{4, 4, std::vector<std::uint8_t>(64, 255), "mask"};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 2; ++x)
      image.rgba[static_cast<std::size_t>(4 * (4 * y + x) + 3)] = 0;  // the left half is a hole
  model.textures.push_back(image);
  model.materials[0].texture = 0;
  model.materials[0].is_alpha_masked = true;
  // An opaque square behind, away from the mask.
  model.materials.emplace_back();
  model.meshes.push_back(square());
  model.meshes[1].material = 1;
  model.instances.push_back({1, glm::translate(glm::dmat4(1), glm::dvec3(0, 0, -3))});
  const auto scene = build(std::move(model));
  const glm::vec3 eye = glm::vec3(-scene->origin()) + glm::vec3(0, 0.37f, 1);
  RayPacket rays = packet_from(eye);
  for (int i = 0; i < kPacketSize; ++i) {
    rays.origin_x[i] += (static_cast<float>(i) + 0.5f) / kPacketSize;
    aim(rays, i, {0, 0, -1});
  }
  HitPacket hits;
  scene->intersect(rays, hits);
  for (int i = 0; i < kPacketSize; ++i) {
    // Bilinear alpha: half at the border (x = 0.5) and, as textures repeat, at x = 0 and 1.
    const bool is_hole = i < 8;
    EXPECT_NEAR(hits.distance[i], is_hole ? 4.0f : 1.0f, 1e-4f) << "lane " << i;
    rays.far[i] = 2.0f;
  }
  EXPECT_EQ(scene->occluded(rays), 0xff00u);
  EXPECT_EQ(scene->occluded_coherent(rays), 0xff00u);
  scene->intersect_scattered(rays, hits);
  for (int i = 0; i < kPacketSize; ++i) EXPECT_EQ(hits.part[i] == kNoHit, i < 8) << "lane " << i;
}

}  // namespace
}  // namespace farfield

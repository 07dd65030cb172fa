// SPDX-License-Identifier: Apache-2.0
// Chunks of a scene: every triangle once, true bounds and cones, found by box, encoded without loss.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "server/scene/chunk_index.h"
#include "server/scene/chunking.h"
#include "server/scene/encoded_cache.h"
#include "tests/unit/server/scene/scene_models.h"

namespace farfield {
namespace {

using namespace test;

using Corners = std::array<glm::vec3, 3>;

// The same triangle whatever vertex it starts with.
std::array<float, 9> canonical(const Corners& t) {
  std::array<float, 9> best{};
  for (int first = 0; first < 3; ++first) {
    std::array<float, 9> rotated;
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a)
        rotated[static_cast<std::size_t>(3 * k + a)] = t[static_cast<std::size_t>((first + k) % 3)][a];
    if (first == 0 || rotated < best) best = rotated;
  }
  return best;
}

std::shared_ptr<const Scene> mixed_scene() {
  Model model = model_of(sphere(30));
  model.instances[0].world_from_mesh = glm::translate(glm::dmat4(1), glm::dvec3(5, 1, 1));
  model.instances.push_back({0, glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(20, 1, 1)), glm::dvec3(-2, 1, 1))});
  model.meshes.push_back(random_triangles(3000, 11, 0.2f));
  model.instances.push_back({1, glm::dmat4(1)});
  return build(std::move(model));
}

TEST(Chunks, HoldEveryTriangleOnce) {
  const Mesh mesh = random_triangles(5000, 4);
  const auto scene = build(model_of(mesh));
  std::multiset<std::array<float, 9>> wanted, found;
  const double step = std::ldexp(8.0, -20);  // scene_frame.h: the extent is between 4 and 8 m
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    Corners t;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 exact = glm::dvec3(mesh.positions[mesh.indices[i + k]]) - scene->origin();
      t[k] = glm::vec3(glm::round(exact / step) * step);
    }
    wanted.insert(canonical(t));
  }
  for (std::uint32_t c = 0; c < scene->chunks().size(); ++c) {
    const Chunk chunk = scene->chunk_geometry(c);
    ASSERT_LE(chunk.indices.size(), 3u * kMaxChunkTriangles);
    EXPECT_EQ(chunk.indices.size(), 3u * scene->chunks()[c].triangles);
    for (std::size_t i = 0; i < chunk.indices.size(); i += 3) {
      Corners t;
      for (std::size_t k = 0; k < 3; ++k)
        t[k] = glm::vec3(scene->chunks()[c].scene_from_chunk *
                         glm::dvec4(chunk.vertices[chunk.indices[i + k]].position, 1));
      found.insert(canonical(t));
    }
  }
  EXPECT_EQ(found.size(), 5000u);
  EXPECT_TRUE(found == wanted) << "on the position grid, exactly";
}

TEST(Chunks, ChunkOfCountsEachChunksTriangles) {
  const auto scene = mixed_scene();
  std::map<std::uint32_t, std::uint32_t> count;
  std::vector<std::uint32_t> part_triangles(scene->parts().size(), 0);
  for (const SceneChunk& chunk : scene->chunks()) part_triangles[chunk.part] += chunk.triangles;
  for (std::uint32_t part = 0; part < part_triangles.size(); ++part)
    for (std::uint32_t t = 0; t < part_triangles[part]; ++t) {
      const std::uint32_t chunk = scene->chunk_of(part, t);
      ASSERT_LT(chunk, scene->chunks().size());
      EXPECT_EQ(scene->chunks()[chunk].part, part);
      ++count[chunk];
    }
  ASSERT_EQ(count.size(), scene->chunks().size());
  for (const auto& [chunk, triangles] : count) EXPECT_EQ(triangles, scene->chunks()[chunk].triangles);
}

TEST(Chunks, ConesAndBoundsHoldForEveryTriangleAsPlaced) {
  const auto scene = mixed_scene();
  int useful = 0;
  for (std::uint32_t c = 0; c < scene->chunks().size(); ++c) {
    const SceneChunk& placed = scene->chunks()[c];
    useful += placed.cone_cos > 0;
    const Chunk chunk = scene->chunk_geometry(c);
    const Box grown = placed.bounds.grown(1e-5);
    for (std::size_t i = 0; i < chunk.indices.size(); i += 3) {
      glm::dvec3 p[3];
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = placed.scene_from_chunk * glm::dvec4(chunk.vertices[chunk.indices[i + k]].position, 1);
        EXPECT_TRUE(grown.contains(p[k]));
      }
      const glm::dvec3 normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
      EXPECT_GE(glm::dot(normal, glm::dvec3(placed.cone_axis)), placed.cone_cos - 1e-3);
    }
    EXPECT_TRUE(scene->parts()[placed.part].bounds.contains(placed.bounds));
    EXPECT_TRUE(scene->bounds().contains(placed.bounds));
  }
  EXPECT_GT(useful, 4) << "a sphere in several chunks has narrow cones";
}

TEST(Chunks, InstancesShareContentAndOtherChunksDoNot) {
  const auto scene = mixed_scene();
  std::map<std::uint32_t, std::set<ContentHash>> hashes;
  std::set<ContentHash> all;
  for (const SceneChunk& chunk : scene->chunks()) {
    hashes[chunk.stored_chunk].insert(chunk.hash);
    all.insert(chunk.hash);
  }
  for (const auto& [stored, set] : hashes) EXPECT_EQ(set.size(), 1u);
  EXPECT_EQ(all.size(), hashes.size());
  EXPECT_LT(hashes.size(), scene->chunks().size());
}

TEST(Chunks, EncodedBytesDecodeToTheSameTriangles) {
  const auto scene = mixed_scene();
  for (std::uint32_t c = 0; c < scene->chunks().size(); ++c) {
    const Chunk chunk = scene->chunk_geometry(c);
    const auto decoded = decode_chunk(*scene->encoded_chunk(c));
    ASSERT_TRUE(decoded) << decoded.error().message;
    std::multiset<std::array<float, 9>> wanted, found;
    for (const auto& [from, to] : {std::pair{&chunk, &wanted}, std::pair{&*decoded, &found}})
      for (std::size_t i = 0; i < from->indices.size(); i += 3)
        to->insert(canonical({from->vertices[from->indices[i]].position, from->vertices[from->indices[i + 1]].position,
                              from->vertices[from->indices[i + 2]].position}));
    EXPECT_TRUE(wanted == found);
    EXPECT_EQ(scene->encoded_chunk(c), scene->encoded_chunk(c)) << "kept, not made again";
  }
}

TEST(Chunks, FoundByBoxAsByLookingAtAll) {
  const auto scene = mixed_scene();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 200; ++round) {
    Box box;
    for (int k = 0; k < 2; ++k)
      box.include(scene->bounds().min +
                  glm::dvec3(unit(random), unit(random), unit(random)) * scene->bounds().extent());
    std::vector<std::uint32_t> wanted;
    for (std::uint32_t c = 0; c < scene->chunks().size(); ++c)
      if (scene->chunks()[c].bounds.intersects(box)) wanted.push_back(c);
    EXPECT_EQ(scene->chunks_in(box), wanted);
  }
  EXPECT_EQ(scene->chunks_in(scene->bounds()).size(), scene->chunks().size());
  EXPECT_TRUE(scene->chunks_in(Box{}).empty());
  EXPECT_TRUE(ChunkIndex().find(scene->bounds()).empty());
}

TEST(Chunks, LargeTrianglesDoNotStretchTheChunksOfSmallOnes) {
  Mesh mesh = random_triangles(2000, 9, 0.02f);
  add_triangle(mesh, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  const auto scene = build(model_of(mesh));
  int large = 0;
  for (const SceneChunk& chunk : scene->chunks()) {
    const glm::dvec3 e = chunk.bounds.extent();
    if (std::max({e.x, e.y, e.z}) > 3.99) {
      ++large;
      EXPECT_EQ(chunk.triangles, 1u);
    }
  }
  EXPECT_EQ(large, 1);
}

TEST(Chunking, ClustersAreFullCompactAndDeterministic) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<TriangleItem> items(64 * 64 + 5);
  for (std::uint32_t i = 0; i < items.size(); ++i) items[i] = {{unit(random), unit(random), 0}, i};
  std::vector<TriangleItem> again = items;
  const std::vector<std::uint32_t> ends = cluster_triangles(items, 64);
  cluster_triangles(again, 64);
  ASSERT_EQ(ends.size(), 65u);
  double area = 0;
  std::uint32_t begin = 0;
  for (const std::uint32_t end : ends) {
    EXPECT_LE(end - begin, 64u);
    Box box;
    for (std::uint32_t i = begin; i < end; ++i) {
      box.include(glm::dvec3(items[i].centre));
      EXPECT_EQ(items[i].triangle, again[i].triangle);
    }
    area += box.extent().x * box.extent().y;
    begin = end;
  }
  EXPECT_EQ(begin, items.size());
  EXPECT_LT(area, 1.0) << "clusters of a plane do not overlap";
}

TEST(EncodedCache, StaysWithinItsBudgetAndForgetsTheOldest) {
  EncodedCache cache(1000);
  int encoded = 0;
  const auto get = [&](std::uint64_t key, std::size_t size) {
    return cache.get(key, [&] {
      ++encoded;
      return Bytes(size, static_cast<std::uint8_t>(key));
    });
  };
  get(1, 400), get(2, 400);
  get(1, 400);
  EXPECT_EQ(encoded, 2);
  get(3, 400);  // pushes out 2
  EXPECT_EQ(cache.size_bytes(), 800u);
  get(1, 400);
  EXPECT_EQ(encoded, 3);
  get(2, 400);
  EXPECT_EQ(encoded, 4);
  EXPECT_EQ(get(9, 5000)->size(), 5000u) << "too large to keep, still given";
  EXPECT_EQ(cache.size_bytes(), 800u);
}

}  // namespace
}  // namespace farfield

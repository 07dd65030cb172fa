// SPDX-License-Identifier: Apache-2.0
// A scene that was written and restored is the scene; one that was damaged is refused, or at least harmless.
#include <gtest/gtest.h>

#include <random>

#include "server/model/generate.h"
#include "tests/unit/server/scene/scene_models.h"

namespace farfield {
namespace {

Bytes written(const Scene& scene) {
  Bytes bytes;
  MemoryImageWriter out([&](ByteView block) { bytes.insert(bytes.end(), block.begin(), block.end()); });
  scene.write(out);
  out.flush();
  return bytes;
}

Result<std::shared_ptr<const Scene>> restored(ByteView bytes) {
  MemoryImageReader in(bytes);
  return Scene::restore(in);
}

std::shared_ptr<const Scene> built(const char* kind, std::size_t triangles) {
  auto scene = Scene::build(generate_model(kind, triangles, 3).value());
  EXPECT_TRUE(scene.has_value());
  return *scene;
}

RayPacket rays_into(const Box& bounds, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  RayPacket rays;
  rays.active = 0xffff;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const auto point = [&] { return bounds.min + bounds.extent() * glm::dvec3(unit(random), unit(random), unit(random)); };
    const glm::dvec3 from = point(), to = point();
    rays.origin_x[lane] = static_cast<float>(from.x), rays.origin_y[lane] = static_cast<float>(from.y), rays.origin_z[lane] = static_cast<float>(from.z);
    rays.direction_x[lane] = static_cast<float>(to.x - from.x), rays.direction_y[lane] = static_cast<float>(to.y - from.y);
    rays.direction_z[lane] = static_cast<float>(to.z - from.z);
    rays.near[lane] = 0, rays.far[lane] = 1e6f;
  }
  return rays;
}

class SceneImage : public testing::TestWithParam<const char*> {};

TEST_P(SceneImage, RestoredItIsTheSameToTheLastBit) {
  const auto scene = built(GetParam(), 20000);
  const Bytes bytes = written(*scene);
  const auto again = restored(bytes);
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ((*again)->hash(), scene->hash());
  EXPECT_EQ((*again)->name(), scene->name());
  EXPECT_EQ((*again)->origin(), scene->origin());
  EXPECT_EQ((*again)->statistics().drawn_triangles, scene->statistics().drawn_triangles);
  EXPECT_EQ((*again)->statistics().stored_triangles, scene->statistics().stored_triangles);
  EXPECT_EQ(written(**again), bytes);
  ASSERT_EQ((*again)->chunks().size(), scene->chunks().size());
  for (std::uint32_t chunk = 0; chunk < scene->chunks().size(); chunk += 7)
    EXPECT_EQ(*(*again)->encoded_chunk(chunk), *scene->encoded_chunk(chunk));
  ASSERT_EQ((*again)->textures().size(), scene->textures().size());
  for (std::uint32_t t = 0; t < scene->textures().size(); ++t)
    EXPECT_EQ(*(*again)->encoded_texture_level(t, 0), *scene->encoded_texture_level(t, 0));
  for (unsigned seed = 0; seed < 50; ++seed) {
    const RayPacket rays = rays_into(scene->bounds(), seed);
    HitPacket first, second;
    scene->intersect(rays, first);
    (*again)->intersect(rays, second);
    float colours[3 * kPacketSize] = {}, colours_again[3 * kPacketSize] = {};
    scene->shade(rays, first, 0.001f, colours);
    (*again)->shade(rays, second, 0.001f, colours_again);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      ASSERT_EQ(first.part[lane], second.part[lane]);
      if (first.part[lane] == kNoHit) continue;
      EXPECT_FLOAT_EQ(first.distance[lane], second.distance[lane]);
      EXPECT_FLOAT_EQ(colours[3 * lane], colours_again[3 * lane]);
    }
    EXPECT_EQ(scene->chunks_in(Box{scene->bounds().min, scene->bounds().center()}), (*again)->chunks_in(Box{scene->bounds().min, scene->bounds().center()}));
  }
}
INSTANTIATE_TEST_SUITE_P(Kinds, SceneImage, testing::Values("pipes", "city", "statues", "house"));

TEST(SceneImageDamage, CutAnywhereItIsRefused) {
  const Bytes bytes = written(*built("pipes", 2000));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 199) {
    EXPECT_FALSE(restored(ByteView(bytes).first(size)).has_value()) << size;
  }
}

TEST(SceneImageDamage, AnyChangedBytesAreRefusedOrHarmless) {
  const Bytes bytes = written(*built("pipes", 2000));
  std::mt19937 random(5);
  int refused = 0;
  for (int n = 0; n < 200; ++n) {
    Bytes damaged = bytes;
    for (int k = 0; k < 4; ++k) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    const auto scene = restored(damaged);
    refused += !scene.has_value();
    if (!scene) continue;
    HitPacket hits;
    const RayPacket rays = rays_into((*scene)->bounds(), 1);
    (*scene)->intersect(rays, hits);
    float colours[3 * kPacketSize];
    (*scene)->shade(rays, hits, 0.001f, colours);
    for (std::uint32_t chunk = 0; chunk < (*scene)->chunks().size(); ++chunk) (*scene)->encoded_chunk(chunk);
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/scene_geometry.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

namespace farfield {
namespace {

// One square, two triangles, at x = `at`.
Mesh square(float at, int material) {
  Mesh mesh;
  mesh.material = material;
  mesh.positions = {{at, 0, 0}, {at + 1, 0, 0}, {at + 1, 1, 0}, {at, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

TextureImage texture(std::uint8_t shade) {
  return {.width = 8, .height = 8, .rgba = std::vector<std::uint8_t>(8 * 8 * 4, shade)};
}

// Two textured squares and a plain one, with different materials.
std::shared_ptr<const Scene> small_scene() {
  Model model;
  model.name = "three squares";
  model.textures = {texture(50), texture(200)};
  model.materials = {{.name = "plain"}, {.name = "dark", .texture = 0}, {.name = "bright", .texture = 1}};
  for (int m = 0; m < 3; ++m) {
    model.meshes.push_back(square(3.0f * static_cast<float>(m), m));
    model.instances.push_back({.mesh = m});
  }
  auto scene = Scene::build(std::move(model));
  return scene ? *scene : nullptr;
}

TEST(SceneGeometry, PlacesChunksWithTheirTextures) {
  const auto scene = small_scene();
  ASSERT_NE(scene, nullptr);
  const auto geometry = scene_geometry(scene);
  ASSERT_EQ(geometry->chunk_count(), scene->chunks().size());
  ASSERT_EQ(geometry->texture_count(), 2u);
  std::set<int> textures;
  for (std::uint32_t chunk = 0; chunk < geometry->chunk_count(); ++chunk) {
    const PlacedSceneChunk placed = geometry->placement(chunk);
    EXPECT_EQ(placed.hash, scene->chunks()[chunk].hash);
    EXPECT_EQ(placed.texture, geometry->placement(chunk).texture) << "the remembered answer is the first one";
    const ContentHash named = scene->chunk_geometry(chunk).texture;
    if (placed.texture >= 0) {
      EXPECT_EQ(geometry->texture(static_cast<std::uint32_t>(placed.texture)).hash, named);
    } else {
      EXPECT_EQ(named, 0u);
    }
    textures.insert(placed.texture);
    EXPECT_FALSE(geometry->chunk(chunk)->empty());
  }
  EXPECT_EQ(textures, (std::set<int>{-1, 0, 1}));
  const SceneTexture info = geometry->texture(0);
  EXPECT_EQ(info.width, 8);
  ASSERT_GT(info.level_count, 0);
  EXPECT_FALSE(geometry->texture_level(0, info.level_count - 1)->empty());
}

TEST(SceneGeometry, TheDescriptionsHashNamesSceneAndSettings) {
  const auto scene = small_scene();
  ASSERT_NE(scene, nullptr);
  ImpostorSettings settings;
  const SceneDescription one = describe_scene(*scene, settings, {1, 2, 3});
  EXPECT_EQ(one.name, "three squares");
  EXPECT_EQ(one.triangles, 6u);
  EXPECT_DOUBLE_EQ(one.start.y, 2.0);
  EXPECT_EQ(describe_scene(*scene, settings, {9, 9, 9}).hash, one.hash);
  settings.colour_quality += 1;
  EXPECT_NE(describe_scene(*scene, settings, {1, 2, 3}).hash, one.hash);
}

}  // namespace
}  // namespace farfield

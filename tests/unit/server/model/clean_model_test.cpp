// SPDX-License-Identifier: Apache-2.0
#include "server/model/clean_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace farfield {
namespace {

using testing::Contains;
using testing::IsEmpty;

Model model_of(Mesh mesh) {
  Model model;
  model.materials.emplace_back();
  model.meshes.push_back(std::move(mesh));
  model.instances.push_back({0, glm::dmat4(1)});
  return model;
}

TEST(CleanModel, LeavesASoundModelAlone) {
  Model model = model_of({.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2, 2, 1, 0}});
  clean_model(model);
  EXPECT_EQ(model.drawn_triangles(), 2u);
  EXPECT_THAT(model.warnings, IsEmpty());
}

TEST(CleanModel, DropsAndCountsEachKindOfBrokenTriangle) {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::nanf("");
  Model model = model_of(
      {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {infinity, 0, 0}, {0, nan, 0}, {3.4e38f, 0, 0}, {2, 0, 0}},
       .indices = {0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 5, 2, 0, 1, 6, 1, 1, 2, 0, 1, 7, 0, 1, 0xffffffff}});
  clean_model(model);
  EXPECT_EQ(model.drawn_triangles(), 1u);
  EXPECT_EQ(model.meshes[0].positions.size(), 3u) << "vertices nobody uses are gone, finite or not";
  EXPECT_THAT(model.warnings, Contains("dropped triangles with vertices that are not finite or beyond 1e9 units: 3"));
  EXPECT_THAT(model.warnings, Contains("dropped triangles without area: 2"));
  EXPECT_THAT(model.warnings, Contains("dropped triangles that name missing vertices: 2"));
}

TEST(CleanModel, KeepsSmallAndThinTriangles) {
  Model model = model_of({.positions = {{0, 0, 0}, {1e-6f, 0, 0}, {0, 1e-6f, 0}, {1000, 0, 0}, {500, 1e-4f, 0}},
                          .indices = {0, 1, 2, 0, 3, 4}});
  clean_model(model);
  EXPECT_EQ(model.drawn_triangles(), 2u);
}

TEST(CleanModel, CompactsEveryAttributeTogether) {
  Model model = model_of({.positions = {{9, 9, 9}, {0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0}},
                          .normals = {{1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {0, 0, 1}},
                          .uvs = {{9, 9}, {1, 1}, {9, 9}, {2, 2}, {3, 3}},
                          .colours = {glm::u8vec4(9), glm::u8vec4(1), glm::u8vec4(9), glm::u8vec4(2), glm::u8vec4(3)},
                          .indices = {4, 1, 3}});
  clean_model(model);
  const Mesh& mesh = model.meshes[0];
  EXPECT_THAT(mesh.indices, testing::ElementsAre(2, 0, 1));
  EXPECT_THAT(mesh.uvs, testing::ElementsAre(glm::vec2(1), glm::vec2(2), glm::vec2(3)));
  EXPECT_THAT(mesh.colours, testing::ElementsAre(glm::u8vec4(1), glm::u8vec4(2), glm::u8vec4(3)));
  EXPECT_EQ(mesh.normals.size(), 3u);
}

TEST(CleanModel, MendsNormalsAndTextureCoordinates) {
  const float nan = std::nanf("");
  Model model = model_of({.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          .normals = {{0, 0, 0}, {nan, 0, 0}, {0, 0, 7}},
                          .uvs = {{nan, 0}, {1, 1}, {0, 1}},
                          .indices = {0, 1, 2}});
  clean_model(model);
  for (const glm::vec3& n : model.meshes[0].normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
  EXPECT_EQ(model.meshes[0].uvs[0], glm::vec2(0));
  EXPECT_THAT(model.warnings, Contains("unusable normals replaced by those of their faces: 2"));
}

TEST(CleanModel, DropsInstancesWithUnusableTransforms) {
  Model model = model_of({.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  glm::dmat4 flat(1), nowhere(1), far(1), mirrored(1);
  flat[1] = glm::dvec4(0);
  nowhere[3].x = std::nan("");
  far[3].z = 1e12;
  mirrored[0].x = -1;
  model.instances = {{0, flat}, {0, nowhere}, {0, far}, {0, mirrored}};
  clean_model(model);
  ASSERT_EQ(model.instances.size(), 1u);
  EXPECT_EQ(model.instances[0].world_from_mesh, mirrored);
  EXPECT_THAT(model.warnings, Contains("dropped instances with unusable transforms: 3"));
}

TEST(CleanModel, RenumbersInstancesWhenMeshesGo) {
  Model model = model_of({.name = "empty"});
  model.meshes.push_back({.name = "kept", .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  model.meshes.push_back({.name = "unused", .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  model.instances.push_back({1, glm::dmat4(1)});
  clean_model(model);
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_EQ(model.meshes[0].name, "kept");
  ASSERT_EQ(model.instances.size(), 1u);
  EXPECT_EQ(model.instances[0].mesh, 0);
}

TEST(CleanModel, DropsMaterialsAndTexturesNobodyUses) {
  Model model = model_of({.material = 2, .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  model.textures = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
  model.materials = {{.name = "x", .texture = 0}, {.name = "y", .texture = 2}, {.name = "z", .texture = 1}};
  drop_unused_materials(model);
  ASSERT_EQ(model.materials.size(), 1u);
  ASSERT_EQ(model.textures.size(), 1u);
  EXPECT_EQ(model.meshes[0].material, 0);
  EXPECT_EQ(model.materials[0].name, "z");
  EXPECT_EQ(model.materials[0].texture, 0);
  EXPECT_EQ(model.textures[0].name, "b");
}

TEST(CleanModel, MergesMaterialsThatLookTheSame) {
  Model model = model_of({.material = 1, .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  model.materials = {{.name = "a"}, {.name = "b"}, {.name = "red", .base_colour = {255, 0, 0, 255}}};
  model.meshes.push_back(model.meshes[0]);
  model.meshes[1].material = 2;
  model.instances.push_back({1, glm::dmat4(1)});
  drop_unused_materials(model);
  ASSERT_EQ(model.materials.size(), 2u);
  EXPECT_EQ(model.materials[static_cast<std::size_t>(model.meshes[0].material)].name, "a");
  EXPECT_EQ(model.materials[static_cast<std::size_t>(model.meshes[1].material)].name, "red");
}

TEST(WeldVertices, JoinsOnlyWhatIsTheSameInEverything) {
  Mesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}},
            .uvs = {{0, 0}, {1, 0}, {0, 1}, {0, 1}, {0.5f, 0}, {1, 1}},
            .indices = {0, 1, 2, 3, 4, 5}};
  weld_vertices(mesh);
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_THAT(mesh.indices, testing::ElementsAre(0, 1, 2, 2, 3, 4));
  EXPECT_EQ(mesh.uvs.size(), 5u);
}

}  // namespace
}  // namespace farfield

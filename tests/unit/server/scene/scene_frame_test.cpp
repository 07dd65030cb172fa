// SPDX-License-Identifier: Apache-2.0
// The scene frame: where its zero lies, what moving the world changes, and what broken models give.
#include "server/scene/scene_frame.h"

#include <gtest/gtest.h>

#include "tests/unit/server/scene/scene_models.h"

namespace farfield {
namespace {

using namespace test;

TEST(SceneFrame, OriginIsTheMinimumCornerOnAPowerOfTwoGrid) {
  const SceneFrame room = choose_scene_frame({{-3.3, 0, 2.7}, {7, 3, 9}});  // extent 10.3: g = 2⁻⁷
  EXPECT_EQ(room.origin, glm::dvec3(std::floor(-3.3 * 128 + 1.0 / 256) / 128, 0, std::floor(2.7 * 128) / 128));
  EXPECT_EQ(room.step_m, std::ldexp(1.0, -16));
  const SceneFrame city = choose_scene_frame({{100.6, -5.2, 0}, {20000, 300, 20000}});
  EXPECT_EQ(city.origin, glm::dvec3(100, -6, 0)) << "at most 1 m";
  EXPECT_EQ(city.step_m, std::ldexp(1.0, 15 - 23)) << "as exact as floats are at the far end";
  const SceneFrame speck = choose_scene_frame({{0, 0, 0}, {1e-3, 1e-3, 1e-3}});
  EXPECT_EQ(speck.step_m, std::ldexp(1.0, -9 - 20)) << "a millionth of the extent";
}

TEST(SceneFrame, MovingTheWorldByTenMillionMetresChangesNothingButTheOrigin) {
  const auto make = [](const glm::dvec3& shift) {
    Model model = model_of(random_triangles(2500, 21));
    const glm::dmat4 turned = glm::rotate(glm::dmat4(1), 0.3, glm::dvec3(0, 1, 0));
    const auto at = [&](double x) { return glm::translate(glm::dmat4(1), shift + glm::dvec3(x, 0.1, 0.7)) * turned; };
    model.instances = {{0, at(0.3)}, {0, at(8.9)}};
    model.meshes.push_back(random_triangles(700, 22));
    model.instances.push_back({1, at(3.7)});
    return build(std::move(model));
  };
  const glm::dvec3 far(1e7, -1e7, 1e7);
  const auto near_scene = make(glm::dvec3(0)), far_scene = make(far);
  EXPECT_EQ(far_scene->origin() - near_scene->origin(), far);
  EXPECT_EQ(far_scene->hash(), near_scene->hash());
  EXPECT_EQ(far_scene->bounds().min, near_scene->bounds().min);
  EXPECT_EQ(far_scene->bounds().max, near_scene->bounds().max);
  ASSERT_EQ(far_scene->chunks().size(), near_scene->chunks().size());
  for (std::size_t c = 0; c < near_scene->chunks().size(); ++c) {
    EXPECT_EQ(far_scene->chunks()[c].hash, near_scene->chunks()[c].hash);
    EXPECT_EQ(far_scene->chunks()[c].scene_from_chunk, near_scene->chunks()[c].scene_from_chunk);
  }
}

TEST(SceneFrame, HashSeesGeometryPlacementAndTextures) {
  const auto hash_of = [](auto change) {
    Model model = model_of(square());
    model.textures.push_back({2, 2, std::vector<std::uint8_t>(16, 100), "grey"});
    model.materials[0].texture = 0;
    change(model);
    return build(std::move(model))->hash();
  };
  const ContentHash plain = hash_of([](Model&) {});
  EXPECT_EQ(hash_of([](Model&) {}), plain);
  EXPECT_NE(hash_of([](Model& m) { m.meshes[0].positions[2].z = 0.01f; }), plain);
  EXPECT_NE(hash_of([](Model& m) { m.meshes[0].uvs[2].x = 0.5f; }), plain);
  EXPECT_NE(hash_of([](Model& m) { m.textures[0].rgba[5] = 101; }), plain);
  EXPECT_NE(hash_of([](Model& m) { m.materials[0].base_colour.r = 254; }), plain);
  EXPECT_NE(hash_of([](Model& m) { m.materials[0].is_alpha_masked = true; }), plain);
}

TEST(SceneBuild, LeavesOutTrianglesThatCannotBeDrawn) {
  Mesh mesh = square();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.uvs.clear();
  add_triangle(mesh, {0, 0, 0}, {1, 1, 1}, {2, 2, 2});
  add_triangle(mesh, {0, nan, 0}, {1, 0, 1}, {0, 1, 0});
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {1, 0, 0});
  mesh.normals.assign(mesh.positions.size(), glm::vec3(0));  // zero normals: flat shading
  const auto scene = build(model_of(mesh));
  EXPECT_EQ(scene->statistics().drawn_triangles, 2u);
}

TEST(SceneBuild, SaysWhatIsWrongWithAModel) {
  const auto error_of = [](auto change) {
    Model model = model_of(square());
    change(model);
    const auto scene = Scene::build(std::move(model));
    EXPECT_FALSE(scene);
    return scene ? std::string() : scene.error().message;
  };
  EXPECT_NE(error_of([](Model& m) { m.meshes[0].indices[3] = 4; }).find("past the last vertex"), std::string::npos);
  EXPECT_NE(error_of([](Model& m) { m.meshes[0].material = 7; }).find("no such material"), std::string::npos);
  EXPECT_NE(error_of([](Model& m) { m.meshes[0].uvs.pop_back(); }).find("uvs"), std::string::npos);
  EXPECT_NE(error_of([](Model& m) { m.instances[0].mesh = -1; }).find("no mesh -1"), std::string::npos);
  EXPECT_NE(error_of([](Model& m) { m.materials[0].texture = 0; }).find("no texture 0"), std::string::npos);
  EXPECT_NE(error_of([](Model& m) { m.textures.push_back({3, 3, {}, "short"}); }).find("3×3"), std::string::npos);
  EXPECT_NE(error_of([](Model& m) { m.instances.clear(); }).find("no triangles"), std::string::npos);
  EXPECT_NE(error_of([](Model& m) { m.meshes[0].positions.assign(4, glm::vec3(1)); }).find("area"), std::string::npos);
}

}  // namespace
}  // namespace farfield

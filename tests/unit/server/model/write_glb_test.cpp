// SPDX-License-Identifier: Apache-2.0
#include "server/model/write_glb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "server/model/load_model.h"
#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

Model two_meshes() {
  Model model;
  model.name = "pair";
  model.textures.push_back(
      {.width = 2, .height = 2, .rgba = {255, 0, 0, 255, 0, 255, 0, 0, 0, 0, 255, 255, 9, 9, 9, 255}, .name = "paint"});
  model.textures.push_back({.width = 1, .height = 1, .rgba = {1, 2, 3, 255}, .name = "dot"});
  model.materials.push_back({.name = "masked",
                             .base_colour = {10, 128, 250, 255},
                             .texture = 0,
                             .is_alpha_masked = true,
                             .alpha_cutoff = 0.25f});
  model.materials.push_back({.name = "plain", .texture = 1});
  model.meshes.push_back({.name = "a",
                          .material = 0,
                          .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
                          .uvs = {{0, 0}, {1, 0.25f}, {0, -3}},
                          .indices = {0, 1, 2}});
  model.meshes.push_back({.name = "b",
                          .material = 1,
                          .positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}},
                          .colours = {{1, 2, 3, 255}, {50, 100, 150, 255}, {255, 254, 253, 255}, {0, 17, 99, 255}},
                          .indices = {0, 1, 2, 0, 2, 3}});
  const glm::dmat4 shifted = glm::translate(glm::dmat4(1), glm::dvec3(10, 20.5, -30));
  model.instances = {{0, glm::dmat4(1)}, {1, shifted}, {1, glm::rotate(shifted, 0.5, glm::dvec3(0, 1, 0))}};
  return model;
}

TEST(WriteGlb, ComesBackThroughTheImporter) {
  const TemporaryFolder folder;
  const Model model = two_meshes();
  ASSERT_TRUE(write_glb(model, folder.path() / "pair.glb"));
  const Result<Model> back = load_model((folder.path() / "pair.glb").string());
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->warnings.empty()) << back->warnings[0];
  ASSERT_EQ(back->meshes.size(), 2u);
  ASSERT_EQ(back->instances.size(), 3u);
  EXPECT_EQ(back->meshes[0].positions, model.meshes[0].positions);
  EXPECT_EQ(back->meshes[0].normals, model.meshes[0].normals);
  EXPECT_EQ(back->meshes[0].indices, model.meshes[0].indices);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(glm::length(back->meshes[0].uvs[i] - model.meshes[0].uvs[i]), 1e-6f);
  EXPECT_EQ(back->meshes[1].colours, model.meshes[1].colours) << "16 bits of linear light hold every sRGB code";
  for (std::size_t t = 0; t < 2; ++t) EXPECT_EQ(back->textures.at(t).rgba, model.textures[t].rgba) << t;
  const Material& material = back->materials[static_cast<std::size_t>(back->meshes[0].material)];
  EXPECT_EQ(material.base_colour, model.materials[0].base_colour);
  EXPECT_TRUE(material.is_alpha_masked);
  EXPECT_FLOAT_EQ(material.alpha_cutoff, 0.25f);
  for (std::size_t i = 0; i < 3; ++i) {
    for (int c = 0; c < 4; ++c) {
      EXPECT_LT(glm::length(back->instances[i].world_from_mesh[c] - model.instances[i].world_from_mesh[c]), 1e-5) << i;
    }
  }
}

TEST(WriteGlb, LeavesNothingBehindWhenItFails) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_glb(two_meshes(), folder.path() / "gone" / "x.glb").error().code, ErrorCode::kIo);
  EXPECT_EQ(write_glb(Model{}, folder.path() / "x.glb").error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace farfield

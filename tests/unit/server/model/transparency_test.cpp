// SPDX-License-Identifier: Apache-2.0
#include "server/model/transparency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace farfield {
namespace {

Model with_material(Material material) {
  Model model;
  model.textures.push_back({.width = 2, .height = 1, .rgba = {255, 255, 255, 255, 255, 255, 255, 150}});
  model.materials.push_back(std::move(material));
  model.meshes.push_back({.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  model.instances = {{0, glm::dmat4(1)}, {0, glm::dmat4(1)}};
  return model;
}

TEST(Transparency, GlassIsAbsentBelowOneHalfAndOpaqueFromThere) {
  Model clear = with_material({.base_colour = {255, 255, 255, 127}, .is_alpha_masked = true});
  settle_transparency(clear);
  EXPECT_EQ(clear.drawn_triangles(), 0u);
  EXPECT_THAT(clear.warnings, testing::ElementsAre(testing::HasSubstr("in glass): 2; materials absent altogether: 1")));

  Model dense = with_material({.base_colour = {255, 255, 255, 128}, .is_alpha_masked = true});
  settle_transparency(dense);
  EXPECT_EQ(dense.drawn_triangles(), 2u);
  EXPECT_FALSE(dense.materials[0].is_alpha_masked);
  EXPECT_EQ(dense.materials[0].base_colour.a, 255);
}

TEST(Transparency, AlphaDoesNotCountWhereTheFileSaysSo) {
  Model model = with_material({.base_colour = {255, 255, 255, 0}, .is_alpha_masked = false});
  settle_transparency(model);
  EXPECT_EQ(model.drawn_triangles(), 2u);
  EXPECT_TRUE(model.warnings.empty());
}

TEST(Transparency, ConstantAlphaMovesIntoTheCutOff) {
  Model model = with_material({.base_colour = {255, 255, 255, 204}, .texture = 0, .is_alpha_masked = true});
  settle_transparency(model);
  EXPECT_TRUE(model.materials[0].is_alpha_masked) << "0.8 · 150/255 is below 0.5";
  EXPECT_NEAR(model.materials[0].alpha_cutoff, 0.625f, 1e-6f);
}

TEST(Transparency, ATextureWithoutHolesNeedsNoTest) {
  Model model = with_material({.texture = 0, .is_alpha_masked = true});
  settle_transparency(model);
  EXPECT_FALSE(model.materials[0].is_alpha_masked) << "150/255 is above 0.5";
}

TEST(Transparency, AMaterialWhoseTextureIsAllHolesIsAbsent) {
  Model model = with_material({.base_colour = {255, 255, 255, 100}, .texture = 0, .is_alpha_masked = true});
  settle_transparency(model);
  EXPECT_EQ(model.drawn_triangles(), 0u);
}

TEST(Transparency, VertexAlphaCountsPerTriangle) {
  Model model = with_material({.is_alpha_masked = true});
  model.meshes[0].positions.push_back({1, 1, 0});
  model.meshes[0].colours = {{255, 255, 255, 0}, {255, 255, 255, 255}, {255, 255, 255, 0}, {255, 255, 255, 255}};
  model.meshes[0].indices = {0, 1, 2, 1, 3, 2};  // mean alpha 1/3 and 2/3
  model.instances.resize(1);
  settle_transparency(model);
  EXPECT_THAT(model.meshes[0].indices, testing::ElementsAre(1, 3, 2));
}

}  // namespace
}  // namespace farfield

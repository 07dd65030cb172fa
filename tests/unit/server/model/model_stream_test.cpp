// SPDX-License-Identifier: Apache-2.0
#include "server/model/model_stream.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <random>

namespace farfield {
namespace {

Model small_model() {
  Model model;
  model.name = "small";
  model.warnings = {"one", "two"};
  model.textures.push_back({.width = 2, .height = 1, .rgba = {1, 2, 3, 4, 5, 6, 7, 8}, .name = "t"});
  model.materials.push_back(
      {.name = "m", .base_colour = {9, 8, 7, 6}, .texture = 0, .is_alpha_masked = true, .alpha_cutoff = 0.25f});
  model.meshes.push_back({.name = "mesh",
                          .material = 0,
                          .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
                          .uvs = {{0, 0}, {1, 0}, {0, 1}},
                          .colours = {glm::u8vec4(1), glm::u8vec4(2), glm::u8vec4(3)},
                          .indices = {0, 1, 2}});
  glm::dmat4 place(1);
  place[3] = {84616.468, 447423.001, -15.125, 1};
  model.instances = {{0, glm::dmat4(1)}, {0, place}};
  return model;
}

Bytes encoded(const Model& model) {
  const int descriptor = memfd_create("test", 0);
  EXPECT_TRUE(write_model_stream(model, descriptor));
  Bytes bytes(static_cast<std::size_t>(lseek(descriptor, 0, SEEK_END)));
  EXPECT_EQ(pread(descriptor, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  close(descriptor);
  return bytes;
}

TEST(ModelStream, ComesBackAsItWent) {
  const Model model = small_model();
  const Result<Model> back = read_model_stream(encoded(model));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->name, model.name);
  EXPECT_EQ(back->warnings, model.warnings);
  EXPECT_EQ(back->textures[0].rgba, model.textures[0].rgba);
  EXPECT_EQ(back->materials[0].base_colour, model.materials[0].base_colour);
  EXPECT_EQ(back->materials[0].alpha_cutoff, model.materials[0].alpha_cutoff);
  EXPECT_EQ(back->meshes[0].positions, model.meshes[0].positions);
  EXPECT_EQ(back->meshes[0].colours, model.meshes[0].colours);
  EXPECT_EQ(back->meshes[0].indices, model.meshes[0].indices);
  EXPECT_EQ(back->instances[1].world_from_mesh, model.instances[1].world_from_mesh);
}

TEST(ModelStream, EveryTruncationIsAnError) {
  const Bytes bytes = encoded(small_model());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(read_model_stream(ByteView(bytes).first(size))) << size;
  }
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(read_model_stream(longer));
}

TEST(ModelStream, AbsurdCountsAreRefusedBeforeMemoryIsTaken) {
  const Bytes bytes = encoded(small_model());
  for (std::size_t at = 0; at + 8 <= bytes.size(); ++at) {
    Bytes damaged = bytes;
    const std::uint64_t absurd = 0x7fffffffffffffffull;
    std::memcpy(damaged.data() + at, &absurd, 8);
    const Result<Model> model = read_model_stream(damaged);  // must not throw or take memory
    if (model) {
      EXPECT_EQ(model->meshes.size(), 1u) << at;
    }
  }
}

TEST(ModelStream, RandomDamageKeepsThePromises) {
  const Bytes bytes = encoded(small_model());
  std::mt19937 random(3);
  for (int round = 0; round < 3000; ++round) {
    Bytes damaged = bytes;
    for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    const Result<Model> model = read_model_stream(damaged);
    if (!model) continue;
    for (const Material& m : model->materials) EXPECT_LT(m.texture, static_cast<int>(model->textures.size()));
    for (const Mesh& m : model->meshes) EXPECT_LT(static_cast<std::size_t>(m.material), model->materials.size());
    for (const MeshInstance& i : model->instances) EXPECT_LT(static_cast<std::size_t>(i.mesh), model->meshes.size());
  }
}

TEST(ModelStream, AFullDiskIsAnError) {
  EXPECT_FALSE(write_model_stream(small_model(), -1));
}

}  // namespace
}  // namespace farfield

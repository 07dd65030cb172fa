// SPDX-License-Identifier: Apache-2.0
// What every generated scene promises: its count, its density, its repeatability and sound meshes.
#include "server/model/generate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "common/base/hash.h"

namespace farfield {
namespace {

ContentHash hash_of(const Model& model) {
  ContentHash hash = 0;
  for (const Mesh& mesh : model.meshes) {
    hash = hash_values<glm::vec3>(mesh.positions, hash);
    hash = hash_values<glm::vec3>(mesh.normals, hash);
    hash = hash_values<glm::vec2>(mesh.uvs, hash);
    hash = hash_values<glm::u8vec4>(mesh.colours, hash);
    hash = hash_values<std::uint32_t>(mesh.indices, hash);
    hash = hash_value(mesh.material, hash);
  }
  for (const MeshInstance& instance : model.instances) {
    hash = hash_value(instance.mesh, hash);
    hash = hash_value(instance.world_from_mesh, hash);
  }
  for (const TextureImage& texture : model.textures) hash = hash_values<std::uint8_t>(texture.rgba, hash);
  return hash;
}

Model generated(const std::string& kind, std::size_t triangles, std::uint64_t seed = 1) {
  Result<Model> model = generate_model(kind, triangles, seed);
  EXPECT_TRUE(model.has_value()) << model.error().message;
  return std::move(*model);
}

/// 60,000 triangles of `kind`, seed 1, made once: painting textures and carving statues is most of a small scene's time.
const Model& sample_of(const std::string& kind) {
  static std::map<std::string, Model> samples;
  const auto at = samples.find(kind);
  return at != samples.end() ? at->second : samples.emplace(kind, generated(kind, 60'000)).first->second;
}

class Generate : public testing::TestWithParam<const char*> {};

TEST_P(Generate, CountIsWithinTwoPercent) {
  EXPECT_NEAR(static_cast<double>(generated(GetParam(), 1'000).drawn_triangles()), 1'000, 20);
  EXPECT_NEAR(static_cast<double>(sample_of(GetParam()).drawn_triangles()), 60'000, 1'200);
}

TEST_P(Generate, SameSeedSameBytesOtherSeedOtherBytes) {
  const ContentHash first = hash_of(sample_of(GetParam()));
  EXPECT_EQ(first, hash_of(generated(GetParam(), 60'000, 1)));
  EXPECT_NE(first, hash_of(generated(GetParam(), 60'000, 6)));
}

TEST_P(Generate, ExtentGrowsWithTheRootOfTheCount) {
  // A module is at most a tenth of the smaller scene, so growth by whole modules stays near the root.
  const std::string kind = GetParam();
  const std::size_t small = kind == "city" || kind == "statues" ? 280'000 : 160'000;
  const auto side = [&](std::size_t triangles) {
    const glm::dvec3 extent = generated(kind, triangles).bounds().extent();
    return std::sqrt(extent.x * extent.z);
  };
  const double growth = side(4 * small) / side(small);
  EXPECT_GT(growth, 1.5);
  EXPECT_LT(growth, 2.7);
}

TEST_P(Generate, MeshesAreSound) {
  const Model& model = sample_of(GetParam());
  std::size_t without_area = 0, bad_numbers = 0, bad_normals = 0, bad_indices = 0;
  for (const Mesh& mesh : model.meshes) {
    ASSERT_LT(static_cast<std::size_t>(mesh.material), model.materials.size());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.colours.size(), mesh.positions.size());
    if (model.materials[static_cast<std::size_t>(mesh.material)].texture >= 0) {
      ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    }
    for (const glm::vec3& p : mesh.positions) bad_numbers += !std::isfinite(p.x + p.y + p.z);
    for (const glm::vec2& uv : mesh.uvs) bad_numbers += !std::isfinite(uv.x + uv.y);
    for (const glm::vec3& n : mesh.normals) bad_normals += !(std::abs(glm::length(n) - 1) < 1e-3f);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const std::uint32_t *t = &mesh.indices[i], count = static_cast<std::uint32_t>(mesh.positions.size());
      if (t[0] >= count || t[1] >= count || t[2] >= count) {
        ++bad_indices;
        continue;
      }
      const glm::dvec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
      without_area += !(glm::length(glm::cross(b - a, c - a)) > 0);
    }
  }
  EXPECT_EQ(without_area, 0u);
  EXPECT_EQ(bad_numbers, 0u);
  EXPECT_EQ(bad_normals, 0u);
  EXPECT_EQ(bad_indices, 0u);
}

TEST_P(Generate, GeometricNormalsAgreeWithShadingNormals) {
  // Winding is consistent: nearly every triangle's own normal lies on its vertices' side (leaf cards are shaded as
  // part of their crown and may not; fields meshed on a grid fold a few slivers over in sharp creases).
  const Model& model = sample_of(GetParam());
  std::size_t against = 0, all = 0;
  for (const Mesh& mesh : model.meshes) {
    if (model.materials[static_cast<std::size_t>(mesh.material)].is_alpha_masked) continue;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const std::uint32_t* t = &mesh.indices[i];
      const glm::vec3 normal = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
      against += glm::dot(normal, mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]) < 0;
      ++all;
    }
  }
  EXPECT_LE(static_cast<double>(against), 0.003 * static_cast<double>(all));
}

TEST_P(Generate, TexturesArePowersOfTwoAndVaried) {
  const Model& model = sample_of(GetParam());
  ASSERT_FALSE(model.textures.empty());
  for (const TextureImage& texture : model.textures) {
    EXPECT_EQ(texture.width & (texture.width - 1), 0);
    EXPECT_EQ(texture.height & (texture.height - 1), 0);
    ASSERT_EQ(texture.rgba.size(), static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height) * 4);
    double sum = 0, squares = 0;
    for (std::size_t i = 1; i < texture.rgba.size(); i += 4) {
      sum += texture.rgba[i];
      squares += texture.rgba[i] * texture.rgba[i];
    }
    const double count = static_cast<double>(texture.rgba.size() / 4);
    EXPECT_GT(squares / count - (sum / count) * (sum / count), 4.0) << texture.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Generate, testing::Values("pipes", "city", "statues", "house"),
                         [](const auto& info) { return std::string(info.param); });

TEST(GenerateModel, RefusesWhatItCannotMake) {
  EXPECT_EQ(generate_model("castle", 5'000, 1).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(generate_model("pipes", 999, 1).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(generate_model("pipes", 50'000'001, 1).error().code, ErrorCode::kInvalidArgument);
}

TEST(GenerateModel, ThePlantIsAsDenseAsARealOne) {
  // A power plant of 12.5 million triangles covers about 250 × 250 m.
  const Model model = generated("pipes", 1'000'000);
  const glm::dvec3 extent = model.bounds().extent();
  const double per_square_metre = static_cast<double>(model.drawn_triangles()) / (extent.x * extent.z);
  EXPECT_GT(per_square_metre, 140);
  EXPECT_LT(per_square_metre, 260);
}

TEST(GenerateModel, StatuesAreSharedNotRepeated) {
  const Model model = generated("statues", 1'000'000);
  std::size_t stored = 0;
  for (const Mesh& mesh : model.meshes) stored += mesh.indices.size() / 3;
  EXPECT_LT(stored * 4, model.drawn_triangles());
}

}  // namespace
}  // namespace farfield

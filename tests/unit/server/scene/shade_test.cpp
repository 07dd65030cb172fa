// SPDX-License-Identifier: Apache-2.0
// Shading against hand computation, and textures against what filtering in linear light must give.
#include <gtest/gtest.h>

#include "common/shading/shading.h"
#include "server/scene/alpha_mask.h"
#include "server/scene/texture_set.h"
#include "tests/unit/server/scene/scene_models.h"

namespace farfield {
namespace {

using namespace test;

TextureImage checkerboard(int width, int height) {
  TextureImage image{width, height, {}, "checkerboard"};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.rgba.insert(image.rgba.end(), 3, (x + y) % 2 ? 255 : 0), image.rgba.push_back(255);
  return image;
}

TEST(Shade, InterpolatesTheRadianceOfVerticesAsClientsReceiveThem) {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {4, 0, 1}, {0, 3, 2});
  mesh.normals = {{0, 1, 0}, glm::normalize(glm::vec3(1, 2, -3)), glm::normalize(glm::vec3(-1, 0.2f, 0.1f))};
  mesh.colours = {{200, 10, 40, 255}, {255, 255, 0, 255}, {0, 128, 255, 255}};
  Model model = model_of(mesh);
  model.materials[0].base_colour = {255, 128, 64, 255};
  const auto scene = build(std::move(model));
  const Chunk chunk = scene->chunk_geometry(0);
  const glm::dmat4x3 place = scene->chunks()[0].scene_from_chunk;
  glm::vec3 radiance[3], corner[3];
  for (int k = 0; k < 3; ++k) {
    const ChunkVertex& vertex = chunk.vertices[chunk.indices[static_cast<std::size_t>(k)]];
    radiance[k] = vertex_radiance(decode_normal(vertex.normal), vertex.colour);
    corner[k] = place * glm::dvec4(vertex.position, 1);
  }
  // Base colour times vertex colour, in linear light.
  EXPECT_EQ(chunk.vertices[chunk.indices[0]].colour.g, linear_to_srgb(srgb_to_linear(128) * srgb_to_linear(10)));
  const float u = 0.2f, v = 0.5f;
  const glm::vec3 target = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
  RayPacket rays = packet_from(target + glm::vec3(0.3f, 0.2f, 5));
  for (int i = 0; i < kPacketSize; ++i) aim(rays, i, -glm::vec3(0.3f, 0.2f, 5));
  rays.active = 0x8001;
  HitPacket hits;
  scene->intersect(rays, hits);
  float rgb[3 * kPacketSize];
  std::fill_n(rgb, 3 * kPacketSize, -1.0f);
  scene->shade(rays, hits, 0.001f, rgb);
  const glm::vec3 expected = (1 - u - v) * radiance[0] + u * radiance[1] + v * radiance[2];
  for (const int lane : {0, 15})
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[3 * lane + c], expected[c], 1e-5f);
  EXPECT_EQ(rgb[3], -1.0f) << "lanes that take no part are untouched";
}

TEST(Shade, FlatTrianglesHaveTheLightOfTheirPlaneFromBothSides) {
  const auto scene = build(model_of(square()));
  for (const float side : {1.0f, -1.0f}) {
    RayPacket rays = packet_from({0.4f, 0.3f, side});
    for (int i = 0; i < kPacketSize; ++i) aim(rays, i, {0, 0, -side});
    HitPacket hits;
    scene->intersect(rays, hits);
    float rgb[3 * kPacketSize];
    scene->shade(rays, hits, 0.001f, rgb);
    EXPECT_FLOAT_EQ(rgb[0], vertex_light({0, 0, 1}));
  }
}

TEST(Shade, FootprintChoosesTheMipLevel) {
  // The first level is a checkerboard; from level 1 on everything is mid grey in linear light: seeing how far a look-up
  // is from grey tells the level that was used.
  const auto contrast = [](float distance, float pixel_angle, const glm::vec3& direction) {
    Model model = model_of(square(1));
    model.textures.push_back(checkerboard(64, 64));
    model.materials[0].texture = 0;
    const auto scene = build(std::move(model));
    // The centre of a white texel: (10.5, 21.5)/64.
    const glm::vec3 target(10.5f / 64, 21.5f / 64, 0);
    RayPacket rays = packet_from(target - direction * distance);
    for (int i = 0; i < kPacketSize; ++i) aim(rays, i, direction);
    HitPacket hits;
    scene->intersect(rays, hits);
    float rgb[3 * kPacketSize];
    scene->shade(rays, hits, pixel_angle, rgb);
    return rgb[0] / vertex_light({0, 0, 1});
  };
  const float grey = srgb_to_linear(linear_to_srgb(0.5f));
  const glm::vec3 straight(0, 0, -1);
  EXPECT_NEAR(contrast(1, 0.9f / 64, straight), 1.0f, 1e-3f) << "less than a texel: level 0";
  EXPECT_NEAR(contrast(1, std::sqrt(2.0f) / 64, straight), 0.5f * (1 + grey), 5e-3f) << "two texels' area: level 1/2";
  EXPECT_NEAR(contrast(1, 2.0f / 64, straight), grey, 5e-3f) << "four texels' area: level 1";
  EXPECT_NEAR(contrast(0.5f, 2.0f * std::sqrt(2.0f) / 64, straight), 0.5f * (1 + grey), 5e-3f)
      << "footprints grow with distance";
  EXPECT_NEAR(contrast(1, std::sqrt(2.0f) / 64, 0.25f * straight), contrast(0.25f, std::sqrt(2.0f) / 64, straight),
              1e-4f)
      << "the length of the direction does not matter";
  const glm::vec3 inclined = glm::normalize(glm::vec3(0, std::sqrt(3.0f), -1));  // cosine 1/2
  EXPECT_NEAR(contrast(0.1f, 10.0f / 64, inclined), 0.5f * (1 + grey), 5e-3f) << "inclination widens footprints";
}

TEST(Shade, FineLookupsLieWhereTurnedRaysMeetThePlane) {
  Model model = model_of(square(3));
  model.textures.push_back(checkerboard(8, 16));
  model.materials[0].texture = 0;
  const auto scene = build(std::move(model));
  const glm::vec3 across(0.02f, 0.01f, 0), down(-0.01f, 0.03f, 0.005f);
  const float sharp = 1e-6f;  // always the first level
  for (int place = 0; place < 40; ++place) {
    const glm::vec3 target(0.3f + 0.01f * static_cast<float>(place), 0.4f + 0.003f * static_cast<float>(place), 0), direction(0.3f, 0.9f, -0.4f);
    const auto shaded = [&](const glm::vec3& turn, bool is_fine) {
      RayPacket rays = packet_from(target - 0.5f * direction);
      for (int i = 0; i < kPacketSize; ++i) aim(rays, i, direction + turn);
      HitPacket hits;
      scene->intersect(rays, hits);
      float rgb[3 * kPacketSize] = {};
      is_fine ? scene->shade_finely(rays, hits, sharp, across, down, rgb) : scene->shade(rays, hits, sharp, rgb);
      return rgb[0];
    };
    float sum = 0;
    for (int k = 0; k < 4; ++k) sum += shaded((k & 1 ? 0.5f : -0.5f) * across + (k & 2 ? 0.5f : -0.5f) * down, false);
    EXPECT_NEAR(shaded(glm::vec3(0), true), 0.25f * sum, 2e-3f) << place;
  }
}

// A textured square seen so that a step of `slope` metres upwards goes with one of a metre away; look-ups around its middle.
double error_of_shading(bool is_fine, float away) {
  Model model = model_of(square(1));
  model.textures.push_back(checkerboard(16, 64));
  model.materials[0].texture = 0;
  const auto scene = build(std::move(model));
  const glm::vec3 direction = glm::normalize(glm::vec3(0, away, -1));
  const float pitch = 1.0f / 64;
  const glm::vec3 across(pitch, 0, 0), down(0, pitch, 0);
  const auto shaded = [&](const glm::vec3& turn, float angle, bool fine) {
    RayPacket rays = packet_from(glm::vec3(0.47f, 0.52f, 0) - 1.0f * direction);
    for (int i = 0; i < kPacketSize; ++i) aim(rays, i, direction + turn);
    HitPacket hits;
    scene->intersect(rays, hits);
    float rgb[3 * kPacketSize];
    if (fine) {
      scene->shade_finely(rays, hits, angle, 0.5f * across, 0.5f * down, rgb);
    } else {
      scene->shade(rays, hits, angle, rgb);
    }
    return rgb[0];
  };
  double sum = 0;
  constexpr int kGrid = 12, kPlaces = 9;
  for (int place = 0; place < kPlaces; ++place) {  // the sample moves over the pattern
    const glm::vec3 centre = static_cast<float>(place) * 0.37f * across + static_cast<float>(place) * 0.23f * down;
    double exact = 0;
    for (int k = 0; k < kGrid * kGrid; ++k)
      exact += shaded(centre + (static_cast<float>(k % kGrid) + 0.5f - kGrid / 2) / kGrid * across +
                          (static_cast<float>(k / kGrid) + 0.5f - kGrid / 2) / kGrid * down, pitch / kGrid, false) / (kGrid * kGrid);
    sum += std::pow(shaded(centre, pitch, is_fine) - exact, 2);
  }
  return std::sqrt(sum / kPlaces);
}

TEST(Shade, SeveralLookupsComeCloserToATextureAtASlant) {
  EXPECT_LT(error_of_shading(true, 2), 0.7 * error_of_shading(false, 2));
}

TEST(Shade, SeveralLookupsOnASplinterOfATriangleStayOnItsTexture) {
  // A millionth of a metre high, on a texture that is white there and black everywhere else: a step of a look-up would lead
  // thousands of triangles away.
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0.5f, 1.0f / (1 << 20), 0});
  mesh.uvs = {{0.05f, 0.05f}, {0.2f, 0.05f}, {0.05f, 0.2f}};
  Model model = model_of(mesh);
  TextureImage image{64, 64, {}, "corner"};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) image.rgba.insert(image.rgba.end(), 3, x < 16 && y < 16 ? 255 : 0), image.rgba.push_back(255);
  model.textures.push_back(std::move(image));
  model.materials[0].texture = 0;
  const auto scene = build(std::move(model));
  RayPacket rays = packet_from({0.5f, 0.25f / (1 << 20), 1});
  for (int i = 0; i < kPacketSize; ++i) aim(rays, i, {0, 0, -1});
  HitPacket hits;
  scene->intersect(rays, hits);
  ASSERT_NE(hits.part[0], kNoHit);
  float rgb[3 * kPacketSize] = {};
  scene->shade_finely(rays, hits, 1e-6f, {0.01f, 0, 0}, {0, 0.01f, 0}, rgb);
  EXPECT_NEAR(rgb[0], vertex_light({0, 0, 1}), 0.02f);
}

TEST(Shade, SeveralLookupsChangeNothingWhereThereIsNoTexture) {
  const auto scene = build(model_of(square()));
  RayPacket rays = packet_from({0.4f, 0.3f, 1});
  for (int i = 0; i < kPacketSize; ++i) aim(rays, i, {0, 0.01f * static_cast<float>(i), -1});
  HitPacket hits;
  scene->intersect(rays, hits);
  float once[3 * kPacketSize] = {}, finely[3 * kPacketSize] = {};
  scene->shade(rays, hits, 0.01f, once);
  scene->shade_finely(rays, hits, 0.01f, {0.005f, 0, 0}, {0, 0.005f, 0}, finely);
  for (int k = 0; k < 3 * kPacketSize; ++k) EXPECT_FLOAT_EQ(once[k], finely[k]);
}

TEST(Mip, CheckerboardAveragesInLinearLight) {
  for (const auto& [width, height] : {std::pair{8, 8}, {64, 16}, {2, 2}}) {
    const std::vector<MipLevel> chain = build_mip_chain(checkerboard(width, height), {});
    for (std::size_t level = 1; level < chain.size(); ++level)
      for (const std::uint32_t texel : chain[level].texels) {
        EXPECT_EQ(texel & 255, 188u) << "half the light is code 188, not 128";
        EXPECT_EQ(texel >> 24, 255u);
      }
  }
}

TEST(Mip, OddSizesKeepTheMean) {
  TextureImage image{7, 5, {}, "gradient"};
  double mean = 0;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) {
      const auto code = static_cast<std::uint8_t>(20 + 30 * x + 4 * y);
      image.rgba.insert(image.rgba.end(), {code, code, code, 255});
      mean += srgb_to_linear(code) / 35.0;
    }
  const std::vector<MipLevel> chain = build_mip_chain(image, {});
  ASSERT_EQ(chain.size(), 3u);
  EXPECT_EQ(chain[1].width, 3);
  EXPECT_EQ(chain[1].height, 2);
  EXPECT_EQ(chain[2].texels.size(), 1u);
  EXPECT_EQ(chain[2].texels[0] & 255, linear_to_srgb(static_cast<float>(mean)));
}

TEST(Mip, ColoursHiddenInHolesDoNotBleed) {
  // White stripes, one in five, between transparent black.
  TextureImage image{80, 80, {}, "fence"};
  for (int i = 0; i < 80 * 80; ++i) {
    const bool is_wire = i % 80 % 5 == 0;
    image.rgba.insert(image.rgba.end(), 3, is_wire ? 255 : 0);
    image.rgba.push_back(is_wire ? 255 : 0);
  }
  const std::vector<MipLevel> chain = build_mip_chain(image, {true, 0.5f, 4096});
  for (std::size_t level = 1; level < chain.size(); ++level)
    for (const std::uint32_t texel : chain[level].texels) {
      if (texel >> 24 == 0) continue;
      EXPECT_GT(texel & 255, 245u) << "level " << level;
    }
}

TEST(Mip, MasksLetTheSameShareThroughAtEveryLevel) {
  // Averaging pulls alpha to its mean, 0.4, below the cutoff: without scaling the leaves would vanish with distance.
  std::mt19937 random(6);
  TextureImage image{128, 128, {}, "leaves"};
  for (int i = 0; i < 128 * 128; ++i) {
    image.rgba.insert(image.rgba.end(), 3, 90);
    image.rgba.push_back(static_cast<std::uint8_t>(random() % 205));
  }
  const auto share = [](const MipLevel& level) {
    double covered = 0;
    for (const std::uint32_t texel : level.texels) covered += (texel >> 24) >= 128 ? 1 : 0;
    return covered / static_cast<double>(level.texels.size());
  };
  const std::vector<MipLevel> chain = build_mip_chain(image, {true, 0.5f, 4096});
  ASSERT_NEAR(share(chain[0]), 77.0 / 205, 0.02);
  for (std::size_t level = 1; level <= 3; ++level) EXPECT_NEAR(share(chain[level]), share(chain[0]), 0.03) << level;
}

TEST(Mip, LargeImagesStartAtTheFirstHalvingThatFits) {
  const std::vector<MipLevel> chain = build_mip_chain(checkerboard(64, 20), {false, 0.5f, 20});
  EXPECT_EQ(chain[0].width, 16);
  EXPECT_EQ(chain[0].height, 5);
}

TEST(TextureSet, RepeatsAndInterpolatesBetweenTexelCentres) {
  TextureImage image{2, 1, {0, 0, 0, 255, 255, 0, 0, 51}, "two"};
  TextureSet set;
  set.add(image, {true, 0.1f, 4096});
  EXPECT_NEAR(set.sample(0, {0.25f, 0.5f}, 0).r, 0.0f, 1e-6f);
  EXPECT_NEAR(set.sample(0, {0.75f, 0.5f}, 0).r, 1.0f, 1e-6f);
  EXPECT_NEAR(set.sample(0, {0.5f, 0.1f}, 0).r, 0.5f, 1e-6f);
  EXPECT_NEAR(set.sample(0, {1.0f, 0.9f}, 0).r, 0.5f, 1e-6f);
  EXPECT_NEAR(set.sample(0, {-3.25f, 7.5f}, 0).r, 1.0f, 1e-6f);
  EXPECT_NEAR(set.sample_alpha(0, {0.75f, 0.5f}), 0.2f, 1e-6f);
  EXPECT_EQ(set.sample(0, {0.3f, 0.5f}, 99.0f), set.sample(0, {0.8f, 0.1f}, 1.0f)) << "past the last level";
}

TEST(TextureSet, FourLookupsAtOnceAreTheirMean) {
  for (const glm::ivec2 size : {glm::ivec2(37, 5), glm::ivec2(1, 1), glm::ivec2(2, 1), glm::ivec2(16, 64)}) {
    TextureImage image{size.x, size.y, {}, "noise"};
    for (int i = 0; i < size.x * size.y; ++i)
      image.rgba.insert(image.rgba.end(), {static_cast<std::uint8_t>(i * 83), static_cast<std::uint8_t>(i * i), static_cast<std::uint8_t>(i * 7 + 3), 255});
    TextureSet set;
    set.add(image, {});
    for (int i = 0; i < 5000; ++i) {
      std::array<glm::vec2, 4> places;
      for (int k = 0; k < 4; ++k)
        places[k] = {std::fmod(0.7548777f * static_cast<float>(4 * i + k), 3.0f) - 1.5f, std::fmod(0.5698403f * static_cast<float>(4 * i + k), 3.0f) - 1.5f};
      if (i == 0) places = {glm::vec2(0), glm::vec2(1), glm::vec2(-1e-9f), glm::vec2(0.99999994f)};
      const float mip = static_cast<float>(i % 50) * 0.1f;
      glm::vec3 sum(0);
      for (const glm::vec2& place : places) sum += set.sample(0, place, mip);
      const glm::vec3 mean = set.mean_of_four(0, places, mip);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(mean[c], 0.25f * sum[c], 1e-6f) << size.x << " " << i;
    }
  }
}

TEST(AlphaMask, AgreesWithTheLookUpItSpares) {
  TextureImage image{37, 5, {}, "holes"};
  for (int i = 0; i < 37 * 5; ++i) image.rgba.insert(image.rgba.end(), {9, 9, 9, static_cast<std::uint8_t>(i * i % 29 < 9 ? i * 7 % 256 : i % 5 ? 255 : 0)});
  TextureSet set;
  set.add(image, {true, 0.5f, 4096});
  for (const float cutoff : {0.25f, 0.5f, 0.9f}) {
    const AlphaMask mask(set, 0, cutoff);
    std::size_t holes = 0;
    for (int i = 0; i < 20000; ++i) {
      const glm::vec2 uv{std::fmod(0.7548777f * static_cast<float>(i), 3.0f) - 1.5f, std::fmod(0.5698403f * static_cast<float>(i), 3.0f) - 1.5f};
      ASSERT_EQ(mask.is_hole(uv), set.sample_alpha(0, uv) < cutoff) << uv.x << " " << uv.y;
      holes += mask.is_hole(uv);
    }
    for (const glm::vec2 uv : {glm::vec2(0), glm::vec2(1), glm::vec2(-1e-9f), glm::vec2(0.99999994f)})
      EXPECT_EQ(mask.is_hole(uv), set.sample_alpha(0, uv) < cutoff) << uv.x;
    EXPECT_GT(holes, 1000u);
    EXPECT_LT(holes, 19000u);
  }
}

TEST(TextureSet, GivesBackTheVeryCodesItWasMadeFrom) {
  TextureImage image{256, 2, {}, "all codes"};
  for (int i = 0; i < 512; ++i) {
    const auto code = static_cast<std::uint8_t>(i);
    image.rgba.insert(image.rgba.end(),
                      {code, static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(i * 7), code});
  }
  TextureSet set;
  set.add(image, {true, 0.5f, 4096});
  EXPECT_EQ(set.texture_level(0, 0).rgba, image.rgba);
}

}  // namespace
}  // namespace farfield

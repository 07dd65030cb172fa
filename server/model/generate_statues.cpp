// SPDX-License-Identifier: Apache-2.0
// A park of statues: plots of 16 m with gravel paths, hedges, trees and scanned-like statues, all placed as instances.
// The budget counts drawn triangles; what is stored is about a tenth of a large park.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "server/model/generators.h"
#include "server/model/growth_order.h"
#include "server/model/noise_tile.h"
#include "server/model/painted_textures.h"
#include "server/model/statue_shapes.h"
#include "server/model/street_furniture.h"

namespace farfield {
namespace {

constexpr int kPlot = 16, kPath = 3;  // metres; a path runs along the low sides of every plot
constexpr std::size_t kStatueTriangles = 30'000;
constexpr double kTau = 6.283185307179586;

/// Relief of the lawn in metres at a world position: gentle enough to walk.
class Relief {
 public:
  double height(double x, double z) const {
    return 0.34 * std::sin(kTau * x / 61) * std::sin(kTau * z / 47) + 0.16 * std::sin(kTau * (x + 2 * z) / 83);
  }
  glm::vec3 normal(double x, double z) const {
    constexpr double kStep = 0.05;
    return glm::normalize(glm::vec3(height(x - kStep, z) - height(x + kStep, z), 2 * kStep, height(x, z - kStep) - height(x, z + kStep)));
  }
};

struct Park {
  ModelBuilder& builder;
  std::uint64_t seed;
  Relief relief;
  Paint grass, gravel, stone;
  std::vector<int> statues, hedges;            // shared meshes
  std::vector<std::array<int, 2>> trees;       // bark and leaves of one tree
  std::vector<std::vector<int>> plinths;       // meshes that stand together
  std::vector<int> bench;
};

glm::dmat4 standing(const glm::dvec3& at, double yaw, double scale) {
  return glm::scale(glm::rotate(glm::translate(glm::dmat4(1), at), yaw, glm::dvec3(0, 1, 0)), glm::dvec3(scale));
}

// Builds an object once, in materials of the park, and keeps its meshes for instances.
template <class Emit>
std::vector<int> shared_object(ModelBuilder& builder, const Model& materials, Emit&& emit) {
  ModelBuilder workshop("", std::size_t{1} << 40);
  for (const Material& material : materials.materials) workshop.add_material(material);
  emit(workshop);
  std::vector<int> meshes;
  for (Mesh& mesh : workshop.finish().meshes) meshes.push_back(builder.add_shared_mesh(std::move(mesh)));
  return meshes;
}

int shared_shape(ModelBuilder& builder, const ModelledShape& shape, std::size_t triangles, int material, const glm::u8vec4& colour) {
  Mesh mesh = mesh_of_field(shape.field, shape.bounds, triangles);
  mesh.name = shape.name;
  mesh.material = material;
  mesh.colours.assign(mesh.positions.size(), colour);
  return builder.add_shared_mesh(std::move(mesh));
}

void add_plinth(ModelBuilder& b, const Paint& stone, float width, float height) {
  const float h = 0.5f * width;
  add_chamfered_box(b, stone, Frame{}, {-h - 0.14f, -0.6f, -h - 0.14f}, {h + 0.14f, 0.12f, h + 0.14f}, 0.02f);
  add_chamfered_box(b, stone, Frame{}, {-h - 0.07f, 0.12f, -h - 0.07f}, {h + 0.07f, 0.22f, h + 0.07f}, 0.03f);
  add_chamfered_box(b, stone, Frame{}, {-h, 0.2f, -h}, {h, height - 0.12f, h}, 0.015f);
  for (const float z : {-h - 0.012f, h}) add_chamfered_box(b, stone, Frame{}, {-0.7f * h, 0.36f, z}, {0.7f * h, height - 0.3f, z + 0.012f}, 0.005f);
  add_chamfered_box(b, stone, Frame{}, {-h - 0.05f, height - 0.12f, -h - 0.05f}, {h + 0.05f, height - 0.06f, h + 0.05f}, 0.02f);
  add_chamfered_box(b, stone, Frame{}, {-h - 0.10f, height - 0.06f, -h - 0.10f}, {h + 0.10f, height, h + 0.10f}, 0.02f);
}

void add_lawn(Park& park, const glm::ivec2& plot, const Paint& paint, glm::ivec2 low, glm::ivec2 high) {
  ModelBuilder& b = park.builder;
  b.try_add([&] {
    std::uint32_t first = 0;
    for (int z = low.y; z <= high.y; ++z) {
      for (int x = low.x; x <= high.x; ++x) {
        const double wx = plot.x * kPlot + x, wz = plot.y * kPlot + z;
        const std::uint32_t i = b.vertex(paint.material, {x, park.relief.height(wx, wz), z}, park.relief.normal(wx, wz), glm::vec2(x, z) * paint.repeats_per_m, paint.colour);
        if (x == low.x && z == low.y) first = i;
      }
    }
    const std::uint32_t row = static_cast<std::uint32_t>(high.x - low.x + 1);
    for (int z = 0; z < high.y - low.y; ++z) {
      for (int x = 0; x < high.x - low.x; ++x) {
        const std::uint32_t i = first + static_cast<std::uint32_t>(z) * row + static_cast<std::uint32_t>(x);
        b.triangle(paint.material, i, i + row, i + row + 1);
        b.triangle(paint.material, i, i + row + 1, i + 1);
      }
    }
  });
}

void add_plot(Park& park, const glm::ivec2& plot) {
  ModelBuilder& b = park.builder;
  RandomStream random(park.seed, 41, plot.x, plot.y);
  const double x0 = plot.x * kPlot, z0 = plot.y * kPlot;
  b.begin_module({x0, 0, z0});
  add_lawn(park, plot, park.gravel, {0, 0}, {kPlot, kPath});
  add_lawn(park, plot, park.gravel, {0, kPath}, {kPath, kPlot});
  add_lawn(park, plot, park.grass, {kPath, kPath}, {kPlot, kPlot});
  const auto place = [&](const std::vector<int>& meshes, double x, double z, double lift, double yaw, double scale) {
    const glm::dvec3 at{x0 + x, park.relief.height(x0 + x, z0 + z) + lift, z0 + z};
    return b.try_add([&] {
      for (const int mesh : meshes) b.place(mesh, standing(at, yaw, scale));
    });
  };
  // One statue in the middle of the lawn, sometimes a group of smaller ones around it.
  const auto place_statue = [&](double x, double z, double scale) {
    const int kind = random.below(static_cast<int>(park.statues.size()));
    const auto& plinth = park.plinths[kind == 3 ? 1 : 0];
    const double yaw = random.between(0.0, kTau);
    if (!place(plinth, x, z, 0, yaw, scale)) return;
    place({park.statues[static_cast<std::size_t>(kind)]}, x, z, 1.04 * scale, yaw, scale * random.between(0.96, 1.05));
  };
  const double middle = 0.5 * (kPath + kPlot);
  place_statue(middle, middle, random.between(1.0, 1.5));
  if (random.chance(0.4)) {
    for (const glm::dvec2 corner : {glm::dvec2(-3.6, -3.6), glm::dvec2(3.6, -3.6), glm::dvec2(-3.6, 3.6), glm::dvec2(3.6, 3.6)}) {
      place_statue(middle + corner.x, middle + corner.y, random.between(0.7, 0.85));
    }
  }
  const double edge = kPath + 0.6, quarter = 0.25 * kTau;
  for (const double along : {kPath + 3.0, kPlot - 3.0}) {
    if (random.chance(0.8)) place({random.pick(park.hedges)}, along, edge, -0.05, 0, 1);
    if (random.chance(0.8)) place({random.pick(park.hedges)}, edge, along, -0.05, quarter, 1);
  }
  for (const glm::dvec2 corner : {glm::dvec2(kPath + 2.2, kPlot - 1.6), glm::dvec2(kPlot - 1.6, kPath + 2.2), glm::dvec2(kPlot - 1.8, kPlot - 1.8)}) {
    if (!random.chance(0.45)) continue;
    const auto& tree = random.pick(park.trees);
    place({tree[0], tree[1]}, corner.x, corner.y, -0.05, random.between(0.0, kTau), random.between(0.8, 1.2));
  }
  if (random.chance(0.7)) place(park.bench, middle, kPath - 0.5, 0, 0.5 * kTau, 1);
}

Park make_park(ModelBuilder& builder, std::size_t triangles, std::uint64_t seed) {
  Park park{builder, seed, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  const auto add = [&](const char* name, TextureImage image, float repeats_per_m, bool is_masked = false) {
    return Paint{builder.add_material(name, builder.add_texture(std::move(image)), is_masked), glm::u8vec4(255), repeats_per_m};
  };
  park.grass = add("grass", paint_grass(seed), 0.25f);
  park.gravel = add("gravel", paint_rough("gravel", {0.66f, 0.60f, 0.50f}, {0.80f, 0.75f, 0.66f}, seed + 1), 0.25f);
  park.stone = add("stone", paint_rough("stone", {0.64f, 0.62f, 0.57f}, {0.78f, 0.76f, 0.71f}, seed + 2), 0.5f);
  const Paint bark = add("bark", paint_rough("bark", {0.26f, 0.20f, 0.15f}, {0.42f, 0.34f, 0.26f}, seed + 3), 1);
  const Paint leaves = add("leaves", paint_leaves({0.28f, 0.44f, 0.15f}, seed + 4), 0, true);
  const Paint plain{builder.add_material("painted"), glm::u8vec4(255), 0};
  const Model& materials = builder.model();

  // A small park has coarser statues, so that there is more than one thing to see.
  const std::size_t fine = std::clamp<std::size_t>(triangles / 8, 120, kStatueTriangles);
  static constexpr std::array<glm::u8vec4, 6> kMarble{{{226, 222, 212, 255}, {232, 230, 226, 255}, {206, 200, 190, 255}, {92, 110, 98, 255}, {120, 96, 70, 255}, {186, 190, 192, 255}}};
  const std::vector<ModelledShape> shapes = statue_shapes(seed);
  RandomStream random(seed, 42);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const auto count = static_cast<std::size_t>(static_cast<double>(fine) * random.between(0.7, 1.3));
    park.statues.push_back(shared_shape(builder, shapes[k], count, plain.material, kMarble[k]));
  }
  for (int k = 0; k < 2; ++k) park.hedges.push_back(shared_shape(builder, hedge_shape(4.2f, seed + 7 + static_cast<std::uint64_t>(k)), std::clamp<std::size_t>(fine / 6, 60, 4000), plain.material, {58, 92, 44, 255}));
  for (int k = 0; k < 3; ++k) {
    const std::vector<int> meshes = shared_object(builder, materials, [&](ModelBuilder& b) {
      RandomStream growth(seed, 43, k);
      add_tree(b, bark, leaves, Frame{}, growth.between(6.0f, 9.0f), growth);
    });
    park.trees.push_back({meshes[0], meshes[1]});
  }
  for (const float width : {1.1f, 2.2f}) park.plinths.push_back(shared_object(builder, materials, [&](ModelBuilder& b) { add_plinth(b, park.stone, width, 1.05f); }));
  park.bench = shared_object(builder, materials, [&](ModelBuilder& b) { add_bench(b, plain, Frame{}); });
  return park;
}

}  // namespace

Model generate_statues(std::size_t triangles, std::uint64_t seed) {
  ModelBuilder builder("statues", triangles);
  Park park = make_park(builder, triangles, seed);
  GrowthOrder order({kPlot, kPlot});
  while (!builder.is_full()) add_plot(park, order.next());
  // The last plot has no room for another statue: a stone garden takes the rest.
  fill_with_boxes(builder, park.stone, {kPath + 2.0f, 0.1f, kPath + 2.0f}, {kPlot - 1.0f, 0.1f, kPlot - 1.0f}, seed);
  return builder.finish();
}

}  // namespace farfield

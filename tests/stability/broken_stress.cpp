// SPDX-License-Identifier: Apache-2.0
// Models as they come: with triangles that are none, twice the same ones, and surfaces in one plane.
#include <fmt/format.h>

#include <algorithm>

#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

void add_vertex(Mesh& mesh, const glm::vec3& p) {
  mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
  mesh.positions.push_back(p);
  mesh.colours.emplace_back(255, 0, 255, 255);
}
void add_triangle(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  for (const glm::vec3& p : {a, b, c}) add_vertex(mesh, p);
}

// Points, segments, needles thinner than the position grid, NaN, infinities and denormals: none of it can be seen.
Model with_degenerate_triangles(Model model) {
  Mesh& mesh = model.meshes[0];
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const float denormal = std::numeric_limits<float>::denorm_min();
  for (int k = 0; k < 200; ++k) {
    // Multiples of the position grid: three of its points on one line stay there.
    const glm::vec3 p(-5.5f + 0.0625f * static_cast<float>(k % 170), 0.25f, 1.0f), along(0.75f, 0.375f, -0.625f);
    add_triangle(mesh, p, p, p);
    add_triangle(mesh, p, p + along, p + 2.0f * along);
    add_triangle(mesh, p, p + along, p + along);
    add_triangle(mesh, p, p + glm::vec3(0, 1, 0), p + glm::vec3(0, 0.5f, 1e-7f));  // a quarter of the grid's half step
    add_triangle(mesh, p, p + glm::vec3(denormal, 0, 0), p + glm::vec3(0, denormal, 0));
    add_triangle(mesh, {denormal, 0, 0}, {0, denormal, 0}, {0, 0, denormal});
    add_triangle(mesh, {nan, 0, 0}, p, p + along);
    add_triangle(mesh, p, p + along, {0, infinity, 0});
  }
  return model;
}

Model with_duplicates(Model model) {
  Mesh& mesh = model.meshes[0];
  const std::vector<std::uint32_t> once = mesh.indices;
  mesh.indices.insert(mesh.indices.end(), once.begin(), once.end());
  for (std::size_t k = 0; k < once.size(); k += 3) mesh.indices.insert(mesh.indices.end(), {once[k], once[k + 2], once[k + 1]});
  return model;
}

// What is cast must not notice: colours and depths of all pixels.
StressRow against_clean(const char* what, Model broken, const Effort& effort) {
  const auto clean = build_scene(hall_model()), scene = build_scene(std::move(broken));
  WorstError worst;
  worst.count(clean->origin() != scene->origin());
  worst.count(clean->bounds().min != scene->bounds().min || clean->bounds().max != scene->bounds().max);
  for (const glm::dvec3& eye : kHallEyes)
    for (int yaw = 0; yaw < 8; ++yaw) {
      const Pose pose{eye - clean->origin(), glm::angleAxis(0.8 * yaw, glm::dvec3(0, 1, 0))};
      const Display display = effort.is_full ? Display{640, 360} : Display{160, 90};
      const ReferenceImage a = render_reference(*clean, pose, display, 1), b = render_reference(*scene, pose, display, 1);
      for (std::size_t k = 0; k < a.disparity.size(); ++k) {
        const bool is_other = !std::equal(&a.rgb[3 * k], &a.rgb[3 * k] + 3, &b.rgb[3 * k]);
        worst.count(is_other || std::abs(a.disparity[k] - b.disparity[k]) > 0);
      }
    }
  return worst.row(what, "the model without them", "pixels that differ", 0);
}

enum class Layers { kBack, kFront, kBoth };
constexpr int kLayerPoses = 12;

std::shared_ptr<const Scene> layered(Layers layers, double apart) {
  test::Blocks blocks;
  // A corner of each in both scenes keeps their bounds, and so their grids and origins, the same.
  blocks.triangle({-3, -3, 0}, {-2.75f, -3, 0}, {-3, -2.75f, 0})
      .triangle({3, 3, static_cast<float>(apart)}, {2.75f, 3, static_cast<float>(apart)}, {3, 2.75f, static_cast<float>(apart)});
  if (layers != Layers::kFront) blocks.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, {60, 60, 200, 255}, 7);
  if (layers != Layers::kBack) blocks.quad({-1.75f, -1.25f, static_cast<float>(apart)}, {3, 0, 0}, {0, 3, 0}, {200, 60, 60, 255}, 3);
  return build_scene(blocks.model());
}
ReferenceImage layer_image(const Scene& scene, int k) {
  return render_reference(scene, {glm::dvec3(0.17 * k - 1, 0.13 * k - 1, 1.0 + 0.3 * k) - scene.origin(), {1, 0, 0, 0}}, {160, 160}, 1);
}

// Two squares of different colours in one plane: every pixel shows what it shows of one of them alone, each time the same.
StressRow coplanar_layers() {
  const auto both = layered(Layers::kBoth, 0), front = layered(Layers::kFront, 0), back = layered(Layers::kBack, 0);
  WorstError worst;
  for (int k = 0; k < kLayerPoses; ++k) {
    const ReferenceImage shown = layer_image(*both, k), again = layer_image(*both, k), a = layer_image(*front, k),
                         b = layer_image(*back, k);
    for (std::size_t p = 0; p < shown.disparity.size(); ++p) {
      const auto is_like = [&](const ReferenceImage& other) {
        return std::equal(&shown.rgb[3 * p], &shown.rgb[3 * p] + 3, &other.rgb[3 * p]) && shown.has_surface[p] == other.has_surface[p];
      };
      worst.count(!is_like(again) || !(is_like(a) || is_like(b)));
    }
  }
  return worst.row("two surfaces in one plane", "either of them alone, each time the same", "pixels that differ", 0);
}

// Layers as close as rays can tell apart: both distances are off by plane_distance_bound() at most, so that of layers twice
// that far from each other the front one shows everywhere.
StressRow close_layers() {
  const double apart = std::exp2(std::ceil(std::log2(2 * plane_distance_bound(0, glm::dvec3(8), 8))));
  const auto both = layered(Layers::kBoth, apart), front = layered(Layers::kFront, apart);
  WorstError worst;
  for (int k = 0; k < kLayerPoses; ++k) {
    const ReferenceImage shown = layer_image(*both, k), wanted = layer_image(*front, k);
    for (std::size_t p = 0; p < shown.disparity.size(); ++p)
      if (wanted.has_surface[p]) worst.count(!std::equal(&shown.rgb[3 * p], &shown.rgb[3 * p] + 3, &wanted.rgb[3 * p]));
  }
  return worst.row(fmt::format("layers {:.0e} of the scene's extent apart", apart / 6), "the front one alone", "pixels that differ", 0);
}

}  // namespace

Rows stress_broken_models(const Effort& effort) {
  return {against_clean("triangles without area, NaN, infinite and denormal vertices", with_degenerate_triangles(hall_model()), effort),
          against_clean("every triangle three times, once turned over", with_duplicates(hall_model()), effort), coplanar_layers(),
          close_layers()};
}

}  // namespace farfield::stability

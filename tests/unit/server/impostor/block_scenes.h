// SPDX-License-Identifier: Apache-2.0
// Small scenes of walls, boxes and rooms, and cells to look at them from, for the tests of the impostor stages.
#pragma once

#include <stdexcept>
#include <utility>

#include "server/impostor/cell_space.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace farfield::test {

/// A scene, and the way from the coordinates it was written in (world) to its own.
struct PlacedScene {
  std::shared_ptr<const Scene> scene;

  glm::dvec3 at(const glm::dvec3& world) const { return world - scene->origin(); }
  Box at(const Box& world) const { return {at(world.min), at(world.max)}; }
};

/// Collects surfaces in world metres. Coordinates that are multiples of 1/1024 survive the scene's grid exactly.
class Blocks {
 public:
  /// The parallelogram corner + [0, 1]·u + [0, 1]·v as pieces × pieces quads; its front looks along u × v.
  Blocks& quad(const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, const glm::u8vec4& colour, int pieces = 1) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (int j = 0; j <= pieces; ++j)
      for (int i = 0; i <= pieces; ++i) {
        const float step = static_cast<float>(pieces);
        mesh_.positions.push_back(corner + u * (static_cast<float>(i) / step) + v * (static_cast<float>(j) / step));
        // A chequered tint, so that a texture error or a shift shows.
        const int tint = (i + j) % 2 ? 30 : 0;
        mesh_.colours.emplace_back(colour.r - tint, colour.g - tint, colour.b - tint, 255);
      }
    const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(j * (pieces + 1) + i); };
    for (int j = 0; j < pieces; ++j)
      for (int i = 0; i < pieces; ++i)
        mesh_.indices.insert(mesh_.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    return *this;
  }
  Blocks& triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    for (const glm::vec3& p : {a, b, c}) {
      mesh_.indices.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
      mesh_.positions.push_back(p);
      mesh_.colours.emplace_back(200, 180, 160, 255);
    }
    return *this;
  }
  /// A closed box seen from outside.
  Blocks& box(const Box& b, const glm::u8vec4& colour = {200, 120, 90, 255}, int pieces = 1) { return faces(b, colour, pieces, false); }
  /// A closed box seen from inside.
  Blocks& room(const Box& b, const glm::u8vec4& colour = {180, 190, 170, 255}, int pieces = 1) { return faces(b, colour, pieces, true); }

  Model model() {
    Model model;
    model.name = "blocks";
    model.materials.emplace_back();
    model.meshes.push_back(std::move(mesh_));
    model.instances.push_back({0, glm::dmat4(1)});
    return model;
  }
  PlacedScene build() {
    auto scene = Scene::build(model());
    if (!scene) throw std::runtime_error(scene.error().message);
    return {*scene};
  }

 private:
  Blocks& faces(const Box& b, const glm::u8vec4& colour, int pieces, bool is_room) {
    const glm::vec3 low(b.min), extent(b.extent());
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 u(0), v(0), across(0);
      u[(axis + 1) % 3] = extent[(axis + 1) % 3], v[(axis + 2) % 3] = extent[(axis + 2) % 3], across[axis] = extent[axis];
      // u × v looks along +axis: right for the upper face seen from outside and the lower one seen from inside.
      const glm::u8vec4 shade(colour.r - 15 * axis, colour.g, colour.b - 10 * axis, 255);
      quad(low + (is_room ? glm::vec3(0) : across), u, v, shade, pieces);
      quad(low + (is_room ? across : glm::vec3(0)), v, u, shade, pieces);
    }
    return *this;
  }
  Mesh mesh_;
};

inline Box cube(const glm::dvec3& center, double side) { return {center - 0.5 * side, center + 0.5 * side}; }

/// A cell of `side_m` around a world point, with kappa = 2; its shell ends with the near region of a parent twice as
/// large around the same point, or never.
inline CellSpace space_around(const PlacedScene& placed, const glm::dvec3& world, double side_m, bool is_root = true) {
  CellSpace space{CellId{}, placed.at(cube(world, side_m)), side_m, {}};
  space.shell.inside = space.box.grown(2 * side_m);
  if (!is_root) space.shell.outside = space.box.grown(0.5 * side_m + 4 * side_m);
  return space;
}

/// A room of 8 m with the cell in its middle: everything can be seen from the centre.
inline Blocks plain_room() { return std::move(Blocks().room({{-4, -4, -4}, {4, 4, 4}}, {180, 190, 170, 255}, 4)); }

/// A pillar that stands in that room from floor to ceiling, outside the near region of a 1 m cell at the origin.
inline const Box kPillar{{2.75, -4, -0.5}, {3.25, 4, 0.5}};
inline Blocks pillar_room() { return std::move(plain_room().box(kPillar, {120, 60, 60, 255}, 2)); }

}  // namespace farfield::test

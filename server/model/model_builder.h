// SPDX-License-Identifier: Apache-2.0
// Collects generated geometry, module by module, up to a triangle budget that is never exceeded.
//
// Positions are metres relative to the current module's origin. Each module makes one mesh per material it uses, so
// that float positions stay exact however far the scene extends. Not thread-safe.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "server/model/model.h"

namespace farfield {

/// How a surface looks: a material, a colour that multiplies it, and how often its texture repeats.
struct Paint {
  int material = 0;
  glm::u8vec4 colour{255};
  float repeats_per_m = 0;  // texture repetitions per metre, for shapes that derive their own coordinates
};

class ModelBuilder {
 public:
  ModelBuilder(std::string name, std::size_t triangle_budget);

  int add_texture(TextureImage texture);
  int add_material(Material material);
  /// A material without texture, or with one.
  int add_material(std::string name, int texture = -1, bool is_alpha_masked = false);

  /// Starts a module: closes the meshes of the one before.
  void begin_module(const glm::dvec3& world_origin);
  std::uint32_t vertex(int material, const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv,
                       const glm::u8vec4& colour);
  /// Triangles without area are left out.
  void triangle(int material, std::uint32_t a, std::uint32_t b, std::uint32_t c);
  /// Free room for `triangles` and `vertices` more in this module's mesh of `material`.
  void reserve(int material, std::size_t vertices, std::size_t triangles);

  /// A mesh for instances; it costs nothing until placed. Returns its index for place().
  int add_shared_mesh(Mesh mesh);
  std::size_t shared_triangles(int mesh) const { return model_.meshes[static_cast<std::size_t>(mesh)].indices.size() / 3; }
  void place(int mesh, const glm::dmat4& world_from_mesh);

  /// Runs `emit`, which adds one object, and takes all of it back if the budget does not allow it.
  /// Returns: true if the object stayed.
  template <class Emit>
  bool try_add(Emit&& emit) {
    const Mark before = mark();
    emit();
    if (triangles_ <= budget_) return true;
    roll_back(before);
    is_full_ = true;
    return false;
  }

  /// Allows `triangles` more: what was held back for finishing touches.
  void raise_budget(std::size_t triangles) { budget_ += triangles; }

  std::size_t triangles() const { return triangles_; }
  std::size_t remaining() const { return budget_ - triangles_; }
  /// True once an object did not fit any more.
  bool is_full() const { return is_full_; }

  /// What is there so far; the current module's meshes are not in it yet.
  const Model& model() const { return model_; }
  Model finish();

 private:
  struct Mark {
    std::vector<std::pair<std::size_t, std::size_t>> sizes;  // vertices and indices per material
    std::size_t instances = 0, triangles = 0;
  };
  Mark mark() const;
  void roll_back(const Mark& mark);
  void close_module();

  Model model_;
  glm::dvec3 origin_{0};
  std::vector<Mesh> open_;  // per material, the current module's mesh
  std::size_t budget_, triangles_ = 0;
  bool is_full_ = false;
};

}  // namespace farfield

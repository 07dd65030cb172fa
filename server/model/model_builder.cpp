// SPDX-License-Identifier: Apache-2.0
#include "server/model/model_builder.h"

#include <glm/gtc/matrix_transform.hpp>

namespace farfield {
namespace {

// Squared sine of the smallest angle a kept triangle may span: float positions a module away cannot hold less.
constexpr float kLeastSquaredSine = 1e-10f;

bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 ab = b - a, ac = c - a;
  const glm::vec3 normal = glm::cross(ab, ac);
  return glm::dot(normal, normal) > kLeastSquaredSine * glm::dot(ab, ab) * glm::dot(ac, ac);
}

}  // namespace

ModelBuilder::ModelBuilder(std::string name, std::size_t triangle_budget) : budget_(triangle_budget) {
  model_.name = std::move(name);
}

int ModelBuilder::add_texture(TextureImage texture) {
  model_.textures.push_back(std::move(texture));
  return static_cast<int>(model_.textures.size()) - 1;
}

int ModelBuilder::add_material(Material material) {
  model_.materials.push_back(std::move(material));
  open_.emplace_back();
  return static_cast<int>(model_.materials.size()) - 1;
}

int ModelBuilder::add_material(std::string name, int texture, bool is_alpha_masked) {
  Material material;
  material.name = std::move(name);
  material.texture = texture;
  material.is_alpha_masked = is_alpha_masked;
  return add_material(std::move(material));
}

void ModelBuilder::begin_module(const glm::dvec3& world_origin) {
  close_module();
  origin_ = world_origin;
}

std::uint32_t ModelBuilder::vertex(int material, const glm::vec3& position, const glm::vec3& normal,
                                   const glm::vec2& uv, const glm::u8vec4& colour) {
  Mesh& mesh = open_[static_cast<std::size_t>(material)];
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  if (model_.materials[static_cast<std::size_t>(material)].texture >= 0) mesh.uvs.push_back(uv);
  mesh.colours.push_back(colour);
  return static_cast<std::uint32_t>(mesh.positions.size()) - 1;
}

void ModelBuilder::triangle(int material, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  Mesh& mesh = open_[static_cast<std::size_t>(material)];
  if (!has_area(mesh.positions[a], mesh.positions[b], mesh.positions[c])) return;
  mesh.indices.push_back(a);
  mesh.indices.push_back(b);
  mesh.indices.push_back(c);
  ++triangles_;
}

void ModelBuilder::reserve(int material, std::size_t vertices, std::size_t triangles) {
  Mesh& mesh = open_[static_cast<std::size_t>(material)];
  mesh.positions.reserve(mesh.positions.size() + vertices);
  mesh.normals.reserve(mesh.normals.size() + vertices);
  mesh.colours.reserve(mesh.colours.size() + vertices);
  mesh.indices.reserve(mesh.indices.size() + 3 * triangles);
}

int ModelBuilder::add_shared_mesh(Mesh mesh) {
  model_.meshes.push_back(std::move(mesh));
  return static_cast<int>(model_.meshes.size()) - 1;
}

void ModelBuilder::place(int mesh, const glm::dmat4& world_from_mesh) {
  model_.instances.push_back({mesh, world_from_mesh});
  triangles_ += shared_triangles(mesh);
}

ModelBuilder::Mark ModelBuilder::mark() const {
  Mark mark;
  mark.sizes.reserve(open_.size());
  for (const Mesh& mesh : open_) mark.sizes.emplace_back(mesh.positions.size(), mesh.indices.size());
  mark.instances = model_.instances.size();
  mark.triangles = triangles_;
  return mark;
}

void ModelBuilder::roll_back(const Mark& mark) {
  for (std::size_t i = 0; i < open_.size(); ++i) {
    Mesh& mesh = open_[i];
    const auto [vertices, indices] = mark.sizes[i];
    mesh.positions.resize(vertices);
    mesh.normals.resize(vertices);
    if (!mesh.uvs.empty()) mesh.uvs.resize(vertices);
    mesh.colours.resize(vertices);
    mesh.indices.resize(indices);
  }
  model_.instances.resize(mark.instances);
  triangles_ = mark.triangles;
}

void ModelBuilder::close_module() {
  for (std::size_t i = 0; i < open_.size(); ++i) {
    Mesh& mesh = open_[i];
    if (!mesh.indices.empty()) {
      mesh.material = static_cast<int>(i);
      mesh.name = model_.materials[i].name;
      mesh.positions.shrink_to_fit();
      mesh.normals.shrink_to_fit();
      mesh.uvs.shrink_to_fit();
      mesh.colours.shrink_to_fit();
      mesh.indices.shrink_to_fit();
      model_.instances.push_back(
          {static_cast<int>(model_.meshes.size()), glm::translate(glm::dmat4(1), origin_)});
      model_.meshes.push_back(std::move(mesh));
    }
    mesh = Mesh{};
  }
}

Model ModelBuilder::finish() {
  close_module();
  return std::move(model_);
}

}  // namespace farfield

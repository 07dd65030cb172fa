// SPDX-License-Identifier: Apache-2.0
#include "server/model/clean_model.h"

#include <cmath>

#include "server/model/double_mesh.h"

namespace farfield {
namespace {

struct Losses {
  std::size_t bad_index = 0, not_finite = 0, no_area = 0;  // triangles
  std::size_t bad_normals = 0, bad_uvs = 0;                // vertices
  std::size_t bad_transforms = 0;                          // instances
};

bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Twice the area vector, in double: exact enough that only truly collinear floats give zero.
glm::dvec3 area_vector(const Mesh& mesh, const std::uint32_t* corner) {
  const glm::dvec3 a = mesh.positions[corner[0]], b = mesh.positions[corner[1]], c = mesh.positions[corner[2]];
  return glm::cross(b - a, c - a);
}

void drop_bad_triangles(Mesh& mesh, Losses& losses) {
  std::size_t kept = 0;
  const std::size_t count = mesh.positions.size();
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t* corner = &mesh.indices[i];
    if (corner[0] >= count || corner[1] >= count || corner[2] >= count) {
      ++losses.bad_index;
      continue;
    }
    bool is_usable = true;
    for (int k = 0; k < 3; ++k) is_usable = is_usable && is_usable_position(mesh.positions[corner[k]]);
    if (!is_usable) {
      ++losses.not_finite;
      continue;
    }
    const glm::dvec3 area = area_vector(mesh, corner);
    if (!(glm::dot(area, area) > 0)) {
      ++losses.no_area;
      continue;
    }
    for (int k = 0; k < 3; ++k) mesh.indices[kept + static_cast<std::size_t>(k)] = corner[k];
    kept += 3;
  }
  mesh.indices.resize(kept);
}

template <class T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& old_of_new) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < old_of_new.size(); ++i) values[i] = values[old_of_new[i]];
  values.resize(old_of_new.size());
}

void drop_unused_vertices(Mesh& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffffu;
  std::vector<std::uint32_t> new_of_old(mesh.positions.size(), kUnused);
  for (const std::uint32_t i : mesh.indices) new_of_old[i] = 0;
  std::vector<std::uint32_t> old_of_new;
  for (std::uint32_t i = 0; i < new_of_old.size(); ++i) {
    if (new_of_old[i] == kUnused) continue;
    new_of_old[i] = static_cast<std::uint32_t>(old_of_new.size());
    old_of_new.push_back(i);
  }
  if (old_of_new.size() == mesh.positions.size()) return;
  // old_of_new[i] >= i: gathering in place only overwrites what has been moved already.
  gather(mesh.positions, old_of_new);
  gather(mesh.normals, old_of_new);
  gather(mesh.uvs, old_of_new);
  gather(mesh.colours, old_of_new);
  for (std::uint32_t& i : mesh.indices) i = new_of_old[i];
}

void mend_normals(Mesh& mesh, Losses& losses) {
  std::vector<glm::dvec3> replacements;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const float length = glm::length(mesh.normals[i]);
    if (std::isfinite(length) && length > 0 && is_finite(mesh.normals[i] / length)) {
      mesh.normals[i] /= length;
      continue;
    }
    if (replacements.empty()) {
      replacements.resize(mesh.positions.size());
      for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::dvec3 area = area_vector(mesh, &mesh.indices[t]);
        for (std::size_t k = 0; k < 3; ++k) replacements[mesh.indices[t + k]] += area;
      }
    }
    const double size = glm::length(replacements[i]);
    mesh.normals[i] = size > 0 ? glm::vec3(replacements[i] / size) : glm::vec3(0, 1, 0);
    ++losses.bad_normals;
  }
}

void mend_uvs(Mesh& mesh, Losses& losses) {
  for (glm::vec2& uv : mesh.uvs) {
    if (std::isfinite(uv.x) && std::isfinite(uv.y)) continue;
    uv = glm::vec2(0);
    ++losses.bad_uvs;
  }
}

Box mesh_bounds(const Mesh& mesh) {
  Box box;
  for (const glm::vec3& p : mesh.positions) box.include(glm::dvec3(p));
  return box;
}

/// Finite, three-dimensional, and no corner of the mesh's box beyond the usable coordinates.
bool is_usable_transform(const glm::dmat4& m, const Box& box) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(m[c][r])) return false;
    }
  }
  if (!(std::abs(glm::determinant(glm::dmat3(m))) > 0)) return false;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                       corner & 4 ? box.max.z : box.min.z);
    if (!is_usable_position(glm::dvec3(m * glm::dvec4(p, 1)))) return false;
  }
  return true;
}

void drop_bad_instances(Model& model, Losses& losses) {
  std::vector<Box> boxes;
  boxes.reserve(model.meshes.size());
  for (const Mesh& mesh : model.meshes) boxes.push_back(mesh_bounds(mesh));
  const auto dropped = std::erase_if(model.instances, [&](const MeshInstance& instance) {
    return !is_usable_transform(instance.world_from_mesh, boxes[static_cast<std::size_t>(instance.mesh)]);
  });
  losses.bad_transforms += dropped;
}

}  // namespace

void clean_model(Model& model) {
  Losses losses;
  for (Mesh& mesh : model.meshes) {
    drop_bad_triangles(mesh, losses);
    drop_unused_vertices(mesh);
    mend_normals(mesh, losses);
    mend_uvs(mesh, losses);
  }
  drop_empty_meshes(model);
  drop_bad_instances(model, losses);
  drop_empty_meshes(model);
  const auto warn = [&](std::size_t count, const char* what) {
    if (count > 0) model.warnings.push_back(fmt::format("{}: {}", what, count));
  };
  warn(losses.bad_index, "dropped triangles that name missing vertices");
  warn(losses.not_finite, "dropped triangles with vertices that are not finite or beyond 1e9 units");
  warn(losses.no_area, "dropped triangles without area");
  warn(losses.bad_normals, "unusable normals replaced by those of their faces");
  warn(losses.bad_uvs, "texture coordinates that are not finite, set to zero");
  warn(losses.bad_transforms, "dropped instances with unusable transforms");
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/model/implicit_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace farfield {
namespace {

constexpr int kBlock = 4;  // cells per edge of the blocks that may be skipped

class Grid {
 public:
  Grid(const DistanceField& field, const Box& bounds, float cell)
      : field_(field), low_(bounds.min), cell_(cell), cells_(glm::max(glm::ivec3(glm::ceil(glm::vec3(bounds.extent()) / cell)), 2)) {
    const glm::ivec3 nodes = cells_ + 1;
    values_.assign(static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z, 0);
    sample();
  }
  const glm::ivec3& cells() const { return cells_; }
  float value(const glm::ivec3& n) const { return values_[index(n)]; }
  glm::vec3 position(const glm::vec3& node) const { return low_ + cell_ * node; }
  std::size_t index(const glm::ivec3& n) const {
    return (static_cast<std::size_t>(n.z) * (cells_.y + 1) + n.y) * (cells_.x + 1) + n.x;
  }
  std::size_t node_count() const { return values_.size(); }

 private:
  void sample() {
    for (int z = 0; z <= cells_.z; z += kBlock) {
      for (int y = 0; y <= cells_.y; y += kBlock) {
        for (int x = 0; x <= cells_.x; x += kBlock) sample_block({x, y, z});
      }
    }
  }
  void sample_block(const glm::ivec3& first) {
    const glm::ivec3 last = glm::min(first + kBlock - 1, cells_);
    const float center = field_(position(glm::vec3(first) + 0.5f * kBlock));
    const bool is_far = std::abs(center) > 0.5f * kBlock * 1.74f * cell_ + 2 * cell_;
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
          values_[index({x, y, z})] = is_far ? center : field_(position({x, y, z}));
        }
      }
    }
  }
  const DistanceField& field_;
  glm::vec3 low_;
  float cell_;
  glm::ivec3 cells_;
  std::vector<float> values_;
};

glm::vec3 gradient(const DistanceField& field, const glm::vec3& p, float step) {
  return glm::vec3(field(p + glm::vec3(step, 0, 0)) - field(p - glm::vec3(step, 0, 0)),
                   field(p + glm::vec3(0, step, 0)) - field(p - glm::vec3(0, step, 0)),
                   field(p + glm::vec3(0, 0, step)) - field(p - glm::vec3(0, 0, step))) /
         (2 * step);
}

// Mean of the edge crossings of the cell whose lowest node is `cell`. Returns: false if the surface does not pass.
bool crossing_mean(const Grid& grid, const glm::ivec3& cell, glm::vec3& mean) {
  float values[8];
  int inside = 0;
  for (int k = 0; k < 8; ++k) {
    values[k] = grid.value(cell + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2));
    inside += values[k] < 0;
  }
  if (inside == 0 || inside == 8) return false;
  glm::vec3 sum{0};
  int crossings = 0;
  for (int k = 0; k < 8; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      const int other = k | (1 << axis);
      if (other == k || (values[k] < 0) == (values[other] < 0)) continue;
      glm::vec3 at(k & 1, (k >> 1) & 1, k >> 2);
      at[axis] = values[k] / (values[k] - values[other]);
      sum += at;
      ++crossings;
    }
  }
  mean = glm::vec3(cell) + sum / static_cast<float>(crossings);
  return true;
}

}  // namespace

Mesh mesh_of_field(const DistanceField& field, const Box& bounds, float cell_m) {
  const Grid grid(field, bounds, cell_m);
  const glm::ivec3 cells = grid.cells();
  Mesh mesh;
  std::vector<std::uint32_t> vertex_of(grid.node_count(), 0xffffffffu);
  for (int z = 0; z < cells.z; ++z) {
    for (int y = 0; y < cells.y; ++y) {
      for (int x = 0; x < cells.x; ++x) {
        glm::vec3 mean;
        if (!crossing_mean(grid, {x, y, z}, mean)) continue;
        glm::vec3 p = grid.position(mean);
        const glm::vec3 g = gradient(field, p, 0.25f * cell_m);
        const float g2 = std::max(glm::dot(g, g), 0.25f);
        const glm::vec3 step = field(p) / g2 * g;
        const float length = glm::length(step);
        if (length < 0.3f * cell_m) p -= step;  // farther steps would fold the mesh over
        vertex_of[grid.index({x, y, z})] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(p);
        const float g_length = glm::length(g);
        mesh.normals.push_back(g_length > 0 ? g / g_length : glm::vec3(0, 1, 0));
      }
    }
  }
  // One quad for every grid edge that crosses the surface, between the four cells around it.
  for (int z = 1; z < cells.z; ++z) {
    for (int y = 1; y < cells.y; ++y) {
      for (int x = 1; x < cells.x; ++x) {
        const glm::ivec3 n{x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 next = n, u{0}, v{0};
          next[axis] += 1;
          u[(axis + 1) % 3] = 1;
          v[(axis + 2) % 3] = 1;
          const bool is_inside = grid.value(n) < 0;
          if (is_inside == (grid.value(next) < 0)) continue;
          std::uint32_t q[4] = {vertex_of[grid.index(n - u - v)], vertex_of[grid.index(n - v)], vertex_of[grid.index(n)], vertex_of[grid.index(n - u)]};
          if (!is_inside) std::swap(q[1], q[3]);
          const auto& p = mesh.positions;
          const bool first_diagonal = glm::distance(p[q[0]], p[q[2]]) <= glm::distance(p[q[1]], p[q[3]]);
          const int s = first_diagonal ? 0 : 1;
          for (const std::uint32_t i : {q[s], q[s + 1], q[s + 2], q[s], q[s + 2], q[(s + 3) % 4]}) mesh.indices.push_back(i);
        }
      }
    }
  }
  return mesh;
}

Mesh mesh_of_field(const DistanceField& field, const Box& bounds, std::size_t triangles) {
  const glm::vec3 extent(bounds.extent());
  const float coarse = std::max({extent.x, extent.y, extent.z}) / 40;
  const Mesh trial = mesh_of_field(field, bounds, coarse);
  const double ratio = static_cast<double>(trial.indices.size() / 3) / static_cast<double>(triangles);
  return mesh_of_field(field, bounds, coarse * static_cast<float>(std::sqrt(ratio)));
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/face_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>

namespace farfield::bench {
namespace {

constexpr std::uint32_t kNoVertex = 0xffffffffu;

void add_quad(std::uint32_t top_left, std::uint32_t top_right, std::uint32_t bottom_left, std::uint32_t bottom_right,
              std::vector<std::uint32_t>& indices) {
  for (const auto& t : {std::array{top_left, bottom_left, top_right}, std::array{top_right, bottom_left, bottom_right}})
    if (std::find(t.begin(), t.end(), kNoVertex) == t.end()) indices.insert(indices.end(), t.begin(), t.end());
}

/// The disparity of the nearest surface among the eight neighbours, 0 if there is none.
float rim_disparity(const FarFace& face, int i, int j) {
  float nearest = 0;
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di)
      if (face.holds(i + di, j + dj)) nearest = std::max(nearest, face.disparity[face.at(i + di, j + dj)]);
  return nearest;
}

/// The four samples around the corner at the upper left of sample (i, j), and which of them are one surface.
class Corner {
 public:
  Corner(const FarFace& face, const Adjacency& adjacency, int i, int j) {
    using A = Adjacency;
    for (int slot = 0; slot < 4; ++slot) label_[slot] = slot;
    const auto join = [&](bool is_joined, int a, int b) {
      if (!is_joined || label_[a] == label_[b]) return;
      const int from = std::max(label_[a], label_[b]), to = std::min(label_[a], label_[b]);
      for (int& label : label_)
        if (label == from) label = to;
    };
    join(adjacency.is_connected(i - 1, j - 1, A::kRight), 0, 1);
    join(adjacency.is_connected(i - 1, j, A::kRight), 2, 3);
    join(adjacency.is_connected(i - 1, j - 1, A::kDown), 0, 2);
    join(adjacency.is_connected(i, j - 1, A::kDown), 1, 3);
    join(adjacency.is_connected(i - 1, j - 1, A::kDownRight), 0, 3);
    join(adjacency.is_connected(i, j - 1, A::kDownLeft), 1, 2);
    float sum[4] = {}, count[4] = {};
    for (int slot = 0; slot < 4; ++slot) {
      const int si = i - 1 + slot % 2, sj = j - 1 + slot / 2;
      if (!face.holds(si, sj) || !face.covered[face.at(si, sj)]) continue;
      sum[label_[slot]] += face.disparity[face.at(si, sj)], count[label_[slot]] += 1;
    }
    for (int label = 0; label < 4; ++label) disparity_[label] = count[label] > 0 ? sum[label] / count[label] : 0;
  }
  /// Slots: upper left, upper right, lower left, lower right. Equal labels are one surface.
  int label(int slot) const { return label_[slot]; }
  float disparity(int label) const { return disparity_[label]; }

 private:
  int label_[4];
  float disparity_[4];
};

/// Vertex numbers of one row of corners, [corner][label].
using CornerRow = std::vector<std::array<std::uint32_t, 4>>;

}  // namespace

FaceMesh rubber_sheet(const FarFace& face) {
  FaceMesh mesh;
  const int edge = face.edge();
  std::vector<std::uint32_t> above(static_cast<std::size_t>(edge), kNoVertex), here(above.size());
  for (int j = 0; j < edge; ++j) {
    for (int i = 0; i < edge; ++i) {
      const float disparity = face.covered[face.at(i, j)] ? face.disparity[face.at(i, j)] : rim_disparity(face, i, j);
      std::uint32_t& vertex = here[static_cast<std::size_t>(i)];
      vertex = kNoVertex;
      if (!(disparity > 0)) continue;
      vertex = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back({static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f, disparity});
    }
    if (j > 0)
      for (std::size_t i = 0; i + 1 < here.size(); ++i) add_quad(above[i], above[i + 1], here[i], here[i + 1], mesh.indices);
    std::swap(above, here);
  }
  return mesh;
}

FaceMesh surface_squares(const FarFace& face, const Adjacency& adjacency, std::span<const std::uint8_t> wanted) {
  FaceMesh mesh;
  const int edge = face.edge();
  const auto is_wanted = [&](int i, int j) { return face.holds(i, j) && wanted[face.at(i, j)] && face.covered[face.at(i, j)]; };
  // A vertex for each surface that some wanted square around the corner belongs to; squares find it under their slot.
  const auto corners = [&](int j, CornerRow& row) {
    for (int i = 0; i <= edge; ++i) {
      std::array<std::uint32_t, 4>& slots = row[static_cast<std::size_t>(i)];
      slots.fill(kNoVertex);
      const bool any = is_wanted(i - 1, j - 1) || is_wanted(i, j - 1) || is_wanted(i - 1, j) || is_wanted(i, j);
      if (!any) continue;
      const Corner corner(face, adjacency, i, j);
      std::array<std::uint32_t, 4> of_label;
      of_label.fill(kNoVertex);
      for (int slot = 0; slot < 4; ++slot) {
        if (!is_wanted(i - 1 + slot % 2, j - 1 + slot / 2)) continue;
        const int label = corner.label(slot);
        std::uint32_t& vertex = of_label[static_cast<std::size_t>(label)];
        if (vertex == kNoVertex) {
          vertex = static_cast<std::uint32_t>(mesh.vertices.size());
          mesh.vertices.push_back({static_cast<float>(i), static_cast<float>(j), corner.disparity(label)});
        }
        slots[static_cast<std::size_t>(slot)] = vertex;
      }
    }
  };
  CornerRow above(static_cast<std::size_t>(edge) + 1), below(above.size());
  corners(0, above);
  for (int j = 0; j < edge; ++j) {
    corners(j + 1, below);
    for (int i = 0; i < edge; ++i)
      if (is_wanted(i, j)) {
        const auto left = static_cast<std::size_t>(i), right = left + 1;
        add_quad(above[left][3], above[right][2], below[left][1], below[right][0], mesh.indices);
      }
    std::swap(above, below);
  }
  return mesh;
}

void simplify(FaceMesh& mesh, double tolerance, double outline) {
  if (mesh.indices.empty()) return;
  std::vector<FaceVertex> metric = mesh.vertices;
  for (FaceVertex& v : metric) v.disparity *= static_cast<float>(outline / tolerance);
  const float extent = meshopt_simplifyScale(&metric[0].column, metric.size(), sizeof(FaceVertex));
  if (!(extent > 0)) return;
  std::vector<std::uint32_t> indices(mesh.indices.size());
  indices.resize(meshopt_simplify(indices.data(), mesh.indices.data(), mesh.indices.size(), &metric[0].column, metric.size(),
                                  sizeof(FaceVertex), 0, static_cast<float>(outline) / extent, 0, nullptr));
  mesh.indices = std::move(indices);
  meshopt_optimizeVertexCache(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(), mesh.vertices.size());
  std::vector<FaceVertex> used(mesh.vertices.size());
  used.resize(meshopt_optimizeVertexFetch(used.data(), mesh.indices.data(), mesh.indices.size(), mesh.vertices.data(),
                                          mesh.vertices.size(), sizeof(FaceVertex)));
  used.shrink_to_fit();
  mesh.vertices = std::move(used);
  mesh.indices.shrink_to_fit();
}

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/voronoi.h"

#include <cmath>

namespace farfield {
namespace {

struct PlaneEquation {  // normal·x = offset
  glm::dvec3 normal;
  double offset;
};

PlaneEquation bisector(const glm::dvec3& a, const glm::dvec3& b) {
  return {b - a, 0.5 * (glm::dot(b, b) - glm::dot(a, a))};
}

}  // namespace

std::vector<glm::dvec3> voronoi_vertices(const std::vector<glm::dvec3>& sites, const Box& box) {
  std::vector<glm::dvec3> vertices;
  // Coordinates relative to the box and in its size, so that one tolerance serves every scale.
  const glm::dvec3 center = box.center();
  const double scale = std::max({box.extent().x, box.extent().y, box.extent().z});
  if (!(scale > 0) || sites.size() < 2) return vertices;
  std::vector<glm::dvec3> points;
  for (const glm::dvec3& site : sites) points.push_back((site - center) / scale);
  const glm::dvec3 half = 0.5 * box.extent() / scale;
  std::vector<PlaneEquation> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      glm::dvec3 normal(0);
      normal[axis] = sign;
      faces.push_back({normal, half[axis]});
    }
  // Rounding in a 3×3 solve with entries of order one and determinant above 1e-6 stays below 1e-9.
  constexpr double kFlat = 1e-6, kSlack = 1e-9;
  const auto try_vertex = [&](std::size_t site, const PlaneEquation& a, const PlaneEquation& b, const PlaneEquation& c) {
    const glm::dmat3 rows = glm::transpose(glm::dmat3(a.normal, b.normal, c.normal));
    if (std::abs(glm::determinant(rows)) < kFlat) return;
    const glm::dvec3 x = glm::inverse(rows) * glm::dvec3(a.offset, b.offset, c.offset);
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(x[axis]) > half[axis] + kSlack) return;
    const double radius = glm::distance(x, points[site]);
    for (const glm::dvec3& other : points)
      if (glm::distance(x, other) < radius - kSlack) return;
    const glm::dvec3 vertex = center + x * scale;
    for (const glm::dvec3& known : vertices)
      if (glm::distance(known, vertex) < kFlat * scale) return;
    vertices.push_back(vertex);
  };
  for (std::size_t s = 0; s < points.size(); ++s) {
    std::vector<PlaneEquation> planes = faces;
    for (std::size_t t = s + 1; t < points.size(); ++t) planes.push_back(bisector(points[s], points[t]));
    for (std::size_t i = 6; i < planes.size(); ++i)  // at least one bisector
      for (std::size_t j = 0; j < i; ++j)
        for (std::size_t k = 0; k < j; ++k) try_vertex(s, planes[i], planes[j], planes[k]);
  }
  return vertices;
}

}  // namespace farfield

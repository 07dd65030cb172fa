// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/patch_mesh.h"

#include <algorithm>
#include <cmath>

#include "common/impostor/cut_cell.h"
#include "common/math/cube_face.h"

namespace farfield {
namespace {

constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

struct CornerSample {
  int x = 0, y = 0;
};

CornerSample corner_sample(int x, int y, int corner) {
  return {x + (corner == 1 || corner == 2), y + (corner >= 2)};
}

CutCell cut_cell_at(const SurfacePatch& patch, int x, int y) {
  CutCell cell;
  for (int k = 0; k < 4; ++k) {
    const CornerSample c = corner_sample(x, y, k);
    cell.is_covered[k] = patch.coverage[patch.at(c.x, c.y)] != 0;
  }
  const std::uint8_t codes[4] = {patch.cut_right[patch.at(x, y)], patch.cut_down[patch.at(x + 1, y)],
                                 patch.cut_right[patch.at(x, y + 1)], patch.cut_down[patch.at(x, y)]};
  for (int k = 0; k < 4; ++k) {
    const bool here = cell.is_covered[k], there = cell.is_covered[(k + 1) & 3];
    cell.is_joined[k] = here == there && (!here || codes[k] == kConnected);
    // Where nothing says how far a surface reaches towards an uncovered sample, halfway is the best guess.
    cell.cut[k] = codes[k] == kConnected ? 0.5f : (static_cast<float>(std::min<int>(codes[k], 8)) - 0.5f) / 8.0f;
  }
  return cell;
}

/// The disparity of the surface at `corner`, carried on in its own plane to `at`.
float continued_disparity(const SurfacePatch& patch, int x, int y, int corner, CellPoint at) {
  const CornerSample c = corner_sample(x, y, corner);
  const CellPoint start = corner_point(corner);
  float disparity = patch.disparity[patch.at(c.x, c.y)];
  const float dx = at.x - start.x, dy = at.y - start.y;
  if (dx < 0 || dx > 0) disparity += std::fabs(dx) * outward_slope(patch, c.x, c.y, 0, dx > 0 ? 1 : -1);
  if (dy < 0 || dy > 0) disparity += std::fabs(dy) * outward_slope(patch, c.x, c.y, 1, dy > 0 ? 1 : -1);
  return std::max(disparity, 0.0f);  // never beyond infinity
}

}  // namespace

void mark_used_vertices(const SurfacePatch& patch, const std::vector<QuadRect>& rects,
                        std::vector<std::uint8_t>& used) {
  used.resize(static_cast<std::size_t>(patch.width) * patch.height);
  for (const QuadRect& r : rects) {
    used[patch.at(r.x0, r.y0)] = 1;
    used[patch.at(r.x1, r.y0)] = 1;
    used[patch.at(r.x0, r.y1)] = 1;
    used[patch.at(r.x1, r.y1)] = 1;
  }
}

void PatchMesher::draw(const SurfacePatch& patch, const PatchPlace& place, const PlanarMerge& merge,
                       const std::vector<QuadRect>& rects, const std::vector<std::uint8_t>& used) {
  patch_ = patch;
  place_ = place;
  vertex_of_.assign(static_cast<std::size_t>(patch.width) * patch.height, kNoVertex);
  for (const QuadRect& r : rects) {
    if (r.quads() > 1) {
      draw_merged(r, merge, used);
      continue;
    }
    const bool is_whole = patch.is_connected(r.x0, r.y0, 0) && patch.is_connected(r.x0, r.y0, 1) &&
                          patch.is_connected(r.x0, r.y1, 0) && patch.is_connected(r.x1, r.y0, 1);
    if (is_whole) {
      draw_plain_quad(r.x0, r.y0);
    } else {
      draw_cut_quad(r.x0, r.y0);
    }
  }
}

void PatchMesher::draw_plain_quad(int x, int y) {
  const std::uint32_t a = sample_vertex(x, y), b = sample_vertex(x + 1, y), c = sample_vertex(x + 1, y + 1),
                      d = sample_vertex(x, y + 1);
  // The diagonal along a crease spans less disparity than the one across it.
  const auto& v = mesh_.vertices;
  if (std::fabs(v[a].disparity - v[c].disparity) <= std::fabs(v[b].disparity - v[d].disparity)) {
    add_triangle(a, b, c);
    add_triangle(a, c, d);
  } else {
    add_triangle(a, b, d);
    add_triangle(b, c, d);
  }
}

void PatchMesher::draw_merged(const QuadRect& r, const PlanarMerge& merge, const std::vector<std::uint8_t>& used) {
  // Round the border, from corner to corner; side k runs from corner k to corner k+1.
  border_.clear();
  std::size_t corner_at[4];
  bool has_extra[4] = {};
  const auto walk = [&](int side, int x, int y, int dx, int dy, int steps) {
    corner_at[side] = border_.size();
    for (int i = 0; i < steps; ++i, x += dx, y += dy) {
      if (i > 0 && !used[patch_.at(x, y)]) continue;
      has_extra[side] |= i > 0;
      border_.push_back(sample_vertex(x, y));
    }
  };
  const int width = r.x1 - r.x0, height = r.y1 - r.y0;
  walk(0, r.x0, r.y0, 1, 0, width);
  walk(1, r.x1, r.y0, 0, 1, height);
  walk(2, r.x1, r.y1, -1, 0, width);
  walk(3, r.x0, r.y1, 0, -1, height);

  const std::size_t count = border_.size();
  for (int corner = 0; corner < 4; ++corner) {  // fan from a corner whose own two sides have no vertex between
    if (has_extra[corner] || has_extra[(corner + 3) & 3]) continue;
    const std::size_t apex = corner_at[corner];
    for (std::size_t k = 1; k + 1 < count; ++k) {
      add_triangle(border_[apex], border_[(apex + k) % count], border_[(apex + k + 1) % count]);
    }
    return;
  }
  const double x = 0.5 * (r.x0 + r.x1), y = 0.5 * (r.y0 + r.y1);
  const std::uint32_t centre = add_vertex(x, y, static_cast<float>(merge.plane(r).at(x, y)));
  for (std::size_t k = 0; k < count; ++k) add_triangle(centre, border_[k], border_[(k + 1) % count]);
}

void PatchMesher::draw_cut_quad(int x, int y) {
  const CutCell cell = cut_cell_at(patch_, x, y);
  const CellPartition partition = divide_cell(cell);
  for (int p = 0; p < partition.size; ++p) {
    const CellPolygon& polygon = partition.polygons[p];
    std::uint32_t vertices[5];
    for (int k = 0; k < polygon.size; ++k) {
      const PolygonPoint& point = polygon.points[k];
      if (point.kind == PolygonPoint::kCorner) {
        const CornerSample c = corner_sample(x, y, point.index);
        vertices[k] = sample_vertex(c.x, c.y);
        continue;
      }
      const CellPoint at = point.kind == PolygonPoint::kCut ? cut_point(cell, point.index) : partition.inner;
      vertices[k] = add_vertex(x + static_cast<double>(at.x), y + static_cast<double>(at.y),
                               continued_disparity(patch_, x, y, point.corner, at));
    }
    for (int k = 1; k + 1 < polygon.size; ++k) add_triangle(vertices[0], vertices[k], vertices[k + 1]);
  }
}

std::uint32_t PatchMesher::sample_vertex(int x, int y) {
  std::uint32_t& vertex = vertex_of_[patch_.at(x, y)];
  if (vertex == kNoVertex) vertex = add_vertex(x, y, patch_.disparity[patch_.at(x, y)]);
  return vertex;
}

std::uint32_t PatchMesher::add_vertex(double x, double y, float disparity) {
  DepthMeshVertex vertex;
  vertex.u = static_cast<float>(sample_tangent(place_.edge_samples, place_.face_x + x));
  vertex.v = static_cast<float>(sample_tangent(place_.edge_samples, place_.face_y + y));
  vertex.disparity = disparity;
  vertex.column = static_cast<float>(place_.texel_x + x + 0.5);
  vertex.row = static_cast<float>(place_.texel_y + y + 0.5);
  mesh_.vertices.push_back(vertex);
  return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
}

void PatchMesher::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh_.indices.push_back(a);
  mesh_.indices.push_back(b);
  mesh_.indices.push_back(c);
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/simplify_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

namespace farfield {
namespace {

/// What the simplifier measures: samples in x and y, and disparity in units in which `tolerance` weighs as much as
/// kOutlineSamples do.
struct MetricPoint {
  float x = 0, y = 0, z = 0;
};

MetricPoint metric_point(const DepthMeshVertex& v, float z_scale) {
  return {v.column, v.row, v.disparity * z_scale};
}

/// Cells draw their cut points one by one; those that coincide become one vertex, so that edges know their neighbours.
void weld(DepthMesh& mesh) {
  std::vector<unsigned int> remap(mesh.vertices.size());
  const std::size_t unique = meshopt_generateVertexRemap(remap.data(), mesh.indices.data(), mesh.indices.size(),
                                                         mesh.vertices.data(), mesh.vertices.size(), sizeof(DepthMeshVertex));
  std::vector<DepthMeshVertex> vertices(unique);
  meshopt_remapVertexBuffer(vertices.data(), mesh.vertices.data(), mesh.vertices.size(), sizeof(DepthMeshVertex), remap.data());
  meshopt_remapIndexBuffer(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(), remap.data());
  mesh.vertices = std::move(vertices);
}

/// 1 at samples all of whose quads are plain: their place lies in one surface, away from every outline that may move.
std::vector<std::uint8_t> inner_samples(const SurfacePatch& patch) {
  std::vector<QuadKind> kinds;
  classify_quads(patch, kinds);
  const int columns = patch.width - 1, rows = patch.height - 1;
  std::vector<std::uint8_t> inner(static_cast<std::size_t>(patch.width) * static_cast<std::size_t>(patch.height), 1);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (kinds[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)] == QuadKind::kPlain) continue;
      inner[patch.at(x, y)] = inner[patch.at(x + 1, y)] = inner[patch.at(x, y + 1)] = inner[patch.at(x + 1, y + 1)] = 0;
    }
  }
  return inner;
}

/// Whether every sample still marked in `left` is shown within `tolerance` by some triangle.
bool shows_samples(const SurfacePatch& patch, const PatchPlace& place, float tolerance, const DepthMesh& mesh,
                   const std::vector<unsigned int>& indices, std::vector<std::uint8_t> left) {
  // Columns count in eighths and sixteenths, so that doubled areas below a thousandth are degenerate, and samples on
  // an edge are off it by rounding only.
  constexpr float kLeastArea = 1e-3f, kRounding = 1e-4f;
  const float origin_x = static_cast<float>(place.texel_x) + 0.5f, origin_y = static_cast<float>(place.texel_y) + 0.5f;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    const DepthMeshVertex &a = mesh.vertices[indices[t]], &b = mesh.vertices[indices[t + 1]], &c = mesh.vertices[indices[t + 2]];
    const float bx = b.column - a.column, by = b.row - a.row, cx = c.column - a.column, cy = c.row - a.row;
    const float area = bx * cy - cx * by;
    if (std::fabs(area) < kLeastArea) continue;
    const auto [low_x, high_x] = std::minmax({a.column, b.column, c.column});
    const auto [low_y, high_y] = std::minmax({a.row, b.row, c.row});
    const int x0 = std::max(0, static_cast<int>(std::ceil(low_x - origin_x))), x1 = std::min(patch.width - 1, static_cast<int>(std::floor(high_x - origin_x)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(low_y - origin_y))), y1 = std::min(patch.height - 1, static_cast<int>(std::floor(high_y - origin_y)));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const std::size_t at = patch.at(x, y);
        if (!left[at]) continue;
        const float px = static_cast<float>(x) + origin_x - a.column, py = static_cast<float>(y) + origin_y - a.row;
        const float share_b = (px * cy - cx * py) / area, share_c = (bx * py - px * by) / area;
        if (share_b < -kRounding || share_c < -kRounding || share_b + share_c > 1 + kRounding) continue;
        const float shown = a.disparity + share_b * (b.disparity - a.disparity) + share_c * (c.disparity - a.disparity);
        if (std::fabs(shown - patch.disparity[at]) <= tolerance) left[at] = 0;
      }
    }
  }
  return std::none_of(left.begin(), left.end(), [](std::uint8_t is_left) { return is_left != 0; });
}

}  // namespace

void simplify_mesh(const SurfacePatch& patch, const PatchPlace& place, float tolerance, DepthMesh& mesh) {
  if (mesh.indices.empty()) return;
  weld(mesh);
  std::vector<MetricPoint> points(mesh.vertices.size());
  const std::vector<std::uint8_t> inner = inner_samples(patch);
  const float z_scale = kOutlineSamples / tolerance;
  std::transform(mesh.vertices.begin(), mesh.vertices.end(), points.begin(),
                 [&](const DepthMeshVertex& v) { return metric_point(v, z_scale); });
  if (!std::all_of(points.begin(), points.end(), [](const MetricPoint& p) { return std::isfinite(p.z); })) return;
  const float extent = meshopt_simplifyScale(&points[0].x, points.size(), sizeof(MetricPoint));
  if (!(extent > 0)) return;
  std::vector<unsigned int> indices;
  for (const float share : {1.0f, 0.5f, 0.25f}) {  // of what may move
    indices.resize(mesh.indices.size());
    indices.resize(meshopt_simplify(indices.data(), mesh.indices.data(), mesh.indices.size(), &points[0].x, points.size(),
                                    sizeof(MetricPoint), 0, share * kOutlineSamples / extent, 0, nullptr));
    if (!shows_samples(patch, place, kWorstOverTolerance * tolerance, mesh, indices, inner)) continue;
    mesh.indices = indices;
    break;
  }
  std::vector<DepthMeshVertex> used(mesh.vertices.size());
  used.resize(meshopt_optimizeVertexFetch(used.data(), mesh.indices.data(), mesh.indices.size(), mesh.vertices.data(),
                                          mesh.vertices.size(), sizeof(DepthMeshVertex)));
  used.shrink_to_fit();
  mesh.vertices = std::move(used);
  mesh.indices.shrink_to_fit();
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/warp_error.h"

#include <algorithm>
#include <cmath>

#include "common/codec/tile_codec.h"
#include "common/impostor/depth_mesh.h"
#include "tests/bench/distribution.h"

namespace farfield::bench {
namespace {

constexpr std::size_t kPoses = 6, kTilesPerPose = 40;

// Disparity of the mesh at each dense sample's place, NaN where no triangle lies: triangles are linear in (u, v).
std::vector<float> mesh_disparity(const DepthMesh& mesh, int width, int height) {
  std::vector<float> at(static_cast<std::size_t>(width) * height, std::nanf(""));
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const DepthMeshVertex *a = &mesh.vertices[mesh.indices[t]], *b = &mesh.vertices[mesh.indices[t + 1]], *c = &mesh.vertices[mesh.indices[t + 2]];
    const float area = (b->column - a->column) * (c->row - a->row) - (c->column - a->column) * (b->row - a->row);
    if (!(std::abs(area) > 1e-6f)) continue;  // slivers between equal columns and rows cover no sample
    const int x0 = std::max(0, static_cast<int>(std::floor(std::min({a->column, b->column, c->column}) - 0.5f)));
    const int x1 = std::min(width - 1, static_cast<int>(std::ceil(std::max({a->column, b->column, c->column}) - 0.5f)));
    const int y0 = std::max(0, static_cast<int>(std::floor(std::min({a->row, b->row, c->row}) - 0.5f)));
    const int y1 = std::min(height - 1, static_cast<int>(std::ceil(std::max({a->row, b->row, c->row}) - 0.5f)));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const float px = static_cast<float>(x) + 0.5f - a->column, py = static_cast<float>(y) + 0.5f - a->row;
        const float wb = (px * (c->row - a->row) - (c->column - a->column) * py) / area;
        const float wc = ((b->column - a->column) * py - px * (b->row - a->row)) / area;
        constexpr float kOnEdge = 1e-4f;  // samples are vertices: rounding must not lose them
        if (wb < -kOnEdge || wc < -kOnEdge || wb + wc > 1 + kOnEdge) continue;
        at[static_cast<std::size_t>(y) * width + x] = a->disparity + wb * (b->disparity - a->disparity) + wc * (c->disparity - a->disparity);
      }
  }
  return at;
}

class Projector {
 public:
  Projector(const Pose& eye, const Display& display) : eye_(eye), display_(display) {
    camera_from_world_ = glm::transpose(glm::dmat3(glm::mat3_cast(eye.world_from_camera)));
  }
  bool project(const glm::dvec3& view, const glm::dvec3& direction, double side, double disparity, glm::dvec2& pixel) const {
    const glm::dvec3 q = camera_from_world_ * (direction + (view - eye_.position) * (disparity / side));
    if (!(q.z < 0)) return false;
    const double pitch = display_.pixel_pitch();
    pixel = {0.5 * display_.width - q.x / q.z / pitch, 0.5 * display_.height + q.y / q.z / pitch};
    return true;
  }
  bool is_inside(const glm::dvec2& p) const { return p.x >= 0 && p.y >= 0 && p.x < display_.width && p.y < display_.height; }

 private:
  const Pose& eye_;
  const Display& display_;
  glm::dmat3 camera_from_world_;
};

void collect(const Tile& exact, const Tile& decoded, bool as_mesh, const CellGrid& grid, const Projector& projector, std::vector<double>& out) {
  const double side = grid.side_m(exact.id.cell.level);
  const glm::dvec3 view = grid.box(exact.id.cell).center() + glm::dvec3(exact.view_offset) * side;
  const CubeFace face = CubeFace::of(exact.id.face);
  std::vector<float> shown = decoded.disparity;
  if (as_mesh) shown = mesh_disparity(build_depth_mesh(decoded, decoded.disparity_tolerance), decoded.width, decoded.height);
  for (int y = 1; y < exact.height; y += 3)
    for (int x = 1; x < exact.width; x += 3) {
      const std::size_t i = static_cast<std::size_t>(y) * exact.width + x;
      if (!exact.coverage[i] || !std::isfinite(shown[i])) continue;
      const double u = sample_tangent(exact.edge_samples, exact.id.x * kTileStride + x);
      const double v = sample_tangent(exact.edge_samples, exact.id.y * kTileStride + y);
      glm::dvec2 wanted, seen;
      if (!projector.project(view, face.direction(u, v), side, exact.disparity[i], wanted) || !projector.is_inside(wanted)) continue;
      if (projector.project(view, face.direction(u, v), side, shown[i], seen)) out.push_back(glm::distance(wanted, seen));
    }
}

}  // namespace

WarpErrors warp_errors(const World& world, const ImpostorSources& sources, const ImpostorSettings& settings, bool as_meshes) {
  const CellGrid grid{settings.finest_side_m};
  std::vector<double> distances;
  WarpErrors result;
  const std::size_t step = std::max<std::size_t>(1, world.poses.size() / kPoses);
  for (std::size_t k = step / 2; k < world.poses.size(); k += step) {
    const Pose& eye = world.poses[k];
    const auto leaf = sources.leaves->leaf_at(eye.position, nullptr);
    if (!leaf) continue;
    const auto plan = sources.leaves->plan(*leaf, nullptr);
    if (!plan) continue;
    // Dense tiles whose centre lies before the eye, evenly picked.
    std::vector<TileId> ahead;
    const glm::dvec3 forward = eye.world_from_camera * glm::dvec3(0, 0, -1);
    for (const NeededTile& tile : (*plan)->tiles) {
      if (tile.id.is_delta()) continue;
      const double u = sample_tangent(settings.edge_samples(), tile.id.x * kTileStride + kTileSamples / 2.0);
      const double v = sample_tangent(settings.edge_samples(), tile.id.y * kTileStride + kTileSamples / 2.0);
      if (glm::dot(glm::normalize(CubeFace::of(tile.id.face).direction(u, v)), forward) > 0.7) ahead.push_back(tile.id);
    }
    const Projector projector(eye, world.options.display);
    const std::size_t every = std::max<std::size_t>(1, ahead.size() / kTilesPerPose);
    std::vector<double> here;
    for (std::size_t t = 0; t < ahead.size(); t += every) {
      TileWork work;
      const Result<Tile> exact = sources.tiles->cast(ahead[t], nullptr, work);
      if (!exact || std::find(exact->coverage.begin(), exact->coverage.end(), 1) == exact->coverage.end()) continue;
      const Result<Bytes> bytes = encode_tile(*exact, {settings.colour_quality});
      if (!bytes) continue;
      const Result<Tile> decoded = decode_tile(*bytes);
      if (decoded) collect(*exact, *decoded, as_meshes, grid, projector, here);
    }
    distances.insert(distances.end(), here.begin(), here.end());
    if (!here.empty()) result.frame_p99[k] = percentile(std::move(here), 0.99);
  }
  result.p99 = percentile(std::move(distances), 0.99);
  return result;
}

}  // namespace farfield::bench

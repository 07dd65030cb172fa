// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/itdm.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "common/cells/sampling.h"

namespace farfield::bench {
namespace {

constexpr int kSearchEdge = 256;  // samples along a face's edge while viewpoints are looked for

/// From the parent up to the root.
std::vector<const FarView*> ancestors_of(std::size_t k, const std::vector<std::size_t>& parents, const std::vector<FarView>& views) {
  std::vector<const FarView*> ancestors;
  for (; parents[k] != k; k = parents[k]) ancestors.push_back(&views[parents[k]]);
  return ancestors;
}

/// Whether a disparity lies within the sample's square of a surface: up to halfway to its neighbours, unless they jump.
bool lies_on_sample(const FarFace& face, const FacePlace& place, double tolerance) {
  const int i = static_cast<int>(std::lround(place.i)), j = static_cast<int>(std::lround(place.j));
  if (!face.holds(i, j) || !face.covered[face.at(i, j)]) return false;
  const double here = face.disparity[face.at(i, j)];
  // On a plane disparity is linear: its change per sample is the same on both sides. A jump has no such partner, and
  // of the two changes the smaller one counts.
  double reach = 0;
  const auto axis = [&](int di, int dj) {
    double least = std::numeric_limits<double>::infinity();
    for (const int sign : {-1, 1}) {
      const int ni = i + sign * di, nj = j + sign * dj;
      if (face.holds(ni, nj) && face.covered[face.at(ni, nj)]) least = std::min(least, std::abs(face.disparity[face.at(ni, nj)] - here));
    }
    if (std::isfinite(least)) reach += 0.5 * least;
  };
  axis(1, 0), axis(0, 1);
  return std::abs(place.disparity - here) <= reach + tolerance;
}

MeshPanel make_panel(const CellSpace& space, const FarFace& face, const Adjacency& adjacency, const std::vector<std::uint8_t>& redundant,
                     bool is_intra, const ItdmOptions& options) {
  std::vector<std::uint8_t> wanted(face.covered.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) wanted[k] = face.covered[k] && (is_intra || !redundant[k]);
  MeshPanel panel{face.frame, face.face, surface_squares(face, adjacency, wanted), {}, {}};
  const MeshTolerance tolerance = MeshTolerance::of(space, face.frame, options.error_px, options.display, options.kappa);
  simplify(panel.mesh, tolerance.disparity, tolerance.outline);
  if (!panel.mesh.indices.empty()) panel.rgb = face.rgb;
  panel.wanted = blocks_under(panel.mesh, face.edge());
  return panel;
}

}  // namespace

MeshTolerance MeshTolerance::of(const CellSpace& space, const ViewFrame& view, double error_px, const Display& display, double kappa) {
  const glm::dvec3 offset = (view.position - space.box.center()) / space.side_m;
  return {disparity_tolerance(offset, kappa, error_px, display), error_px * display.pixel_pitch() / view.pitch};
}

ScanTree dependency_tree(std::vector<glm::dvec3> positions) {
  const std::size_t count = positions.size();
  glm::dvec3 centroid(0);
  for (const glm::dvec3& p : positions) centroid += p / static_cast<double>(count);
  std::size_t root = 0;
  for (std::size_t k = 1; k < count; ++k)
    if (glm::distance(positions[k], centroid) < glm::distance(positions[root], centroid)) root = k;
  // Prim: always the sample nearest to the tree. Cubed or not, distances have one order, and so one tree.
  std::vector<std::size_t> parent(count, root);
  std::vector<std::uint8_t> is_in(count, 0);
  is_in[root] = 1;
  for (std::size_t added = 1; added < count; ++added) {
    std::size_t best = count;
    const auto weight = [&](std::size_t k) { return glm::distance(positions[k], positions[parent[k]]); };
    for (std::size_t k = 0; k < count; ++k)
      if (!is_in[k] && (best == count || weight(k) < weight(best))) best = k;
    is_in[best] = 1;
    for (std::size_t k = 0; k < count; ++k)
      if (!is_in[k] && glm::distance(positions[k], positions[best]) < glm::distance(positions[k], positions[parent[k]])) parent[k] = best;
  }
  return {std::move(positions), std::move(parent)};
}

std::vector<std::uint8_t> redundant_samples(const FarFace& face, std::span<const FarView* const> ancestors, double tolerance) {
  std::vector<std::uint8_t> redundant(face.covered.size(), 0);
  tbb::parallel_for(0, face.edge(), [&](int j) {
    for (int i = 0; i < face.edge(); ++i) {
      if (!face.covered[face.at(i, j)]) continue;
      const glm::dvec3 point = face.point(i, j);
      redundant[face.at(i, j)] = std::any_of(ancestors.begin(), ancestors.end(), [&](const FarView* view) {
        const FarFace& other = view->faces[static_cast<std::size_t>(face_towards(view->position, point))];
        const std::optional<FacePlace> place = place_on(other.frame, point);
        return place && lies_on_sample(other, *place, tolerance);
      });
    }
  });
  return redundant;
}

ItdmCell make_itdm(const Scene& scene, const CellSpace& space, double eye_height, const ItdmOptions& options) {
  ItdmCell cell;
  cell.found = find_views(eye_rectangle(space.box, eye_height), space.side_m, options.search,
                          [&](const glm::dvec3& position) { return cast_far_view(scene, space, position, kSearchEdge); });
  cell.tree = dependency_tree(cell.found.positions);
  const std::vector<std::size_t>& parents = cell.tree.parents;
  std::vector<FarView> views;
  for (std::size_t k = 0; k < parents.size(); ++k) {
    const auto start = std::chrono::steady_clock::now();
    views.push_back(cast_far_view(scene, space, cell.found.positions[k], options.face_samples));
    if (parents[k] == k) cell.intra_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  std::vector<const FarView*> all;
  for (const FarView& view : views) all.push_back(&view);
  for (std::size_t k = 0; k < views.size(); ++k) {
    const std::vector<const FarView*> ancestors = ancestors_of(k, parents, views);
    std::array<MeshPanel, kCubeFaces> panels;
    std::array<std::vector<std::uint8_t>, kCubeFaces> redundant;
    const bool is_intra = parents[k] == k;
    tbb::parallel_for(0, kCubeFaces, [&](int f) {
      const auto at = static_cast<std::size_t>(f);
      const FarFace& face = views[k].faces[at];
      if (!is_intra) redundant[at] = redundant_samples(face, ancestors, SkinLimits::one_sample(face.frame));
      panels[at] = make_panel(space, face, connect_surfaces(face, all), redundant[at], is_intra, options);
    });
    for (std::size_t f = 0; f < panels.size(); ++f) {
      cell.panels.push_back(std::move(panels[f]));
      if (is_intra) continue;
      cell.samples += static_cast<std::size_t>(std::count(views[k].faces[f].covered.begin(), views[k].faces[f].covered.end(), 1));
      cell.redundant += static_cast<std::size_t>(std::count(redundant[f].begin(), redundant[f].end(), 1));
    }
  }
  return cell;
}

}  // namespace farfield::bench

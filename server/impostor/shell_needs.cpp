// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/shell_needs.h"

#include <algorithm>
#include <limits>
#include <set>

#include "common/cells/sampling.h"
#include "server/impostor/held_points.h"
#include "server/impostor/sample_density.h"

namespace farfield {
namespace {

constexpr double kSphere = 4 * 3.14159265358979323846;

// The tile or region of a view that a direction falls into.
TileId tile_towards(const CellId& cell, int view, const glm::dvec3& direction, const ImpostorSettings& settings) {
  const int edge_samples = settings.edge_samples(static_cast<std::uint8_t>(view));
  const int face = dominant_face(direction);
  const CubeFace frame = CubeFace::of(face);
  const double scale = 1.0 / std::abs(direction[frame.axis]);
  const double i = sample_index(edge_samples, direction[frame.u_axis()] * scale);
  const double j = sample_index(edge_samples, direction[frame.v_axis()] * scale);
  TileId id{cell, static_cast<std::uint8_t>(view), static_cast<std::uint8_t>(face), 0, 0};
  const int step = id.is_delta() ? kRegionSamples : kTileStride;
  const int count = id.is_delta() ? face_regions(edge_samples) : face_tiles(edge_samples);
  const auto place = [&](double index) { return static_cast<std::uint8_t>(std::clamp(static_cast<int>(index) / step, 0, count - 1)); };
  id.x = place(i), id.y = place(j);
  return id;
}

// Tiles of which less is seen than this, as a share of the sphere, are not worth their bytes: a delta tile takes about half
// those of an intra tile, and there are many more that are hardly seen.
constexpr double kLeastIntraShare = 1e-6, kLeastDeltaShare = 2e-7;

// The most that slant_density() can be, seen from within `reach_m` of `from`: nobody there is farther from the plane, or nearer to
// the point, than by that.
double most_density(const FarHit& hit, const glm::dvec3& from, double reach_m) {
  const glm::dvec3 normal(hit.normal), to_point = glm::dvec3(hit.point) - from;
  const double nearest = glm::length(to_point) - reach_m;
  if (nearest <= 0) return std::numeric_limits<double>::infinity();
  return (std::abs(glm::dot(normal, to_point)) + glm::length(normal) * reach_m) / (nearest * nearest);
}

}  // namespace

std::uint64_t tiles_of(const ImpostorSettings& settings, std::size_t views) {
  const auto square = [](int edge) { return static_cast<std::uint64_t>(kCubeFaces) * edge * edge; };
  const std::uint64_t delta = square(face_regions(settings.edge_samples(1)));
  return square(face_tiles(settings.edge_samples(kIntraView))) + (views - 1) * delta;
}

ShellNeeds::ShellNeeds(const Scene& scene, CellSpace space, std::shared_ptr<const ShellViews> views, const ImpostorSettings& settings,
                       const BoxVisibility& sight)
    : scene_(scene), space_(space), views_(std::move(views)), settings_(settings), viewpoints_{sight.viewpoints}, seen_(sight.enclosures.size() + 1) {
  for (const EnclosureVisibility& enclosed : sight.enclosures) {
    viewpoints_.push_back(enclosed.viewpoints);
    viewpoints_[0] -= enclosed.viewpoints;
  }
  slack_ = disparity_tolerance(glm::dvec3(0), settings.kappa, settings.tau_px, settings.display) * (0.5 + settings.kappa);
}

// Of each point the first view that holds it, and those later ones whose samples of it are so much denser that they keep them
// (void_finder.h, by the same rule).
void ShellNeeds::ask_delta_views() {
  const std::vector<glm::dvec3>& positions = views_->positions;
  std::vector<WaitingHit> held;
  for (std::size_t view = 0; view < positions.size() && !waiting_.empty(); ++view) {
    const auto density_of = [&](const WaitingHit& w) { return slant_density(glm::dvec3(w.normal), glm::dvec3(w.point) - positions[view]); };
    double farthest = 0;  // of later views from this one
    for (std::size_t later = view + 1; later < positions.size(); ++later) farthest = std::max(farthest, glm::distance(positions[view], positions[later]));
    const double stretch = largest_stretch(settings_, static_cast<std::uint8_t>(view));
    held.clear();
    drop_held(scene_, space_, slack_, PointSpacing::kSparse, positions[view], waiting_,
              [&](const WaitingHit& w) { return w.density_enough > 0 && density_of(w) <= w.density_enough; },
              [&](const WaitingHit& w) {
                mark(static_cast<int>(view), w, w.density_enough > 0);
                const double enough = stretch * density_of(w);
                if (most_density(w, positions[view], farthest) > enough) held.push_back({w, enough});
              });
    waiting_.insert(waiting_.end(), held.begin(), held.end());
  }
  waiting_.clear();
}

void ShellNeeds::count_skips(LeafSkips& skips) const {
  std::set<TileId> seen;
  for (const auto& of_enclosure : seen_)
    for (const auto& [id, here] : of_enclosure) seen.insert(id);
  skips.tiles_unseen += tiles_of(settings_, views_->positions.size()) - seen.size();
  for (const TileId& id : seen) skips.tiles_too_small += !is_worth_sending(id);
}

void ShellNeeds::list(int enclosure, std::vector<NeededTile>& tiles) const {
  std::map<TileId, double> seen;
  std::size_t viewpoints = 0;
  for (std::size_t k = 0; k < seen_.size(); ++k) {
    if (enclosure != kWhole && static_cast<std::size_t>(enclosure) + 1 != k) continue;
    viewpoints += viewpoints_[k];
    for (const auto& [id, here] : seen_[k])
      if (is_worth_sending(id)) seen[id] += here.first;
  }
  const double spheres = kSphere * static_cast<double>(std::max<std::size_t>(1, viewpoints));
  std::vector<NeededTile> mine;
  for (const auto& [id, solid_angle] : seen) mine.push_back({id, static_cast<float>(solid_angle / spheres)});
  std::stable_sort(mine.begin(), mine.end(), [](const NeededTile& a, const NeededTile& b) {
    if (a.id.is_delta() != b.id.is_delta()) return b.id.is_delta();
    return a.view_share > b.view_share;
  });
  tiles.insert(tiles.end(), mine.begin(), mine.end());
}

// Somebody sees enough of it: viewers in one of the enclosures, or in none.
bool ShellNeeds::is_worth_sending(const TileId& id) const {
  const double least = kSphere * (id.is_delta() ? kLeastDeltaShare : kLeastIntraShare);
  for (std::size_t k = 0; k < seen_.size(); ++k)
    if (const auto found = seen_[k].find(id);
        found != seen_[k].end() && found->second.first + found->second.again >= least * static_cast<double>(viewpoints_[k]))
      return true;
  return false;
}

// The probe sends some hundred rays into each tile from each of its viewpoints: what none of them met is too small to
// be worth a tile.
void ShellNeeds::mark(int view, const FarHit& hit, bool is_held) {
  const glm::dvec3 direction = glm::dvec3(hit.point) - views_->positions[view];
  Seen& seen = seen_[static_cast<std::size_t>(hit.enclosure + 1)][tile_towards(space_.cell, view, direction, settings_)];
  (is_held ? seen.again : seen.first) += hit.solid_angle;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/shell_views.h"

#include <algorithm>

#include "common/cells/sampling.h"
#include "server/impostor/held_points.h"
#include "server/impostor/sample_density.h"
#include "server/impostor/voronoi.h"
#include "server/visibility/standpoints.h"

namespace farfield {
namespace {

constexpr int kProbeEdge = 48;  // rays per face edge and candidate: 1.9 degrees, averaged over all candidates

constexpr int kRefinements = 2;

constexpr int kScattered = 16;  // candidates off the lattice: viewers walk at heights that it may miss

// The R3 sequence (Roberts 2018) fills a box evenly.
glm::dvec3 scattered_point(const Box& box, int index) {
  const glm::dvec3 place = glm::dvec3(0.8191725133961645, 0.6710436067037893, 0.5497004779019703) * static_cast<double>(index + 1);
  return box.min + box.extent() * (place - glm::floor(place));
}

// A surface point that a candidate sees in the shell and no view holds yet.
struct Unheld {
  glm::vec3 point, normal;  // the normal of any length
  float solid_angle;
};

struct Candidate {
  glm::dvec3 position;
  std::vector<Unheld> unheld;
  double void_sr = 0;
};

class ViewSearch {
 public:
  ViewSearch(const Scene& scene, const CellSpace& space, const ImpostorSettings& settings)
      : scene_(scene), space_(space), settings_(settings) {
    slack_ = disparity_tolerance(glm::dvec3(0), settings.kappa, settings.tau_px, settings.display) * (0.5 + settings.kappa);
  }

  void add_candidate(const glm::dvec3& position) {
    for (const Candidate& known : candidates_)
      if (glm::distance(known.position, position) < 0.05 * space_.side_m) return;
    Candidate candidate{position, {}, 0};
    cast_sphere(scene_, position, kProbeEdge, {0.5, 0.5}, space_.shell,
                [&](const RayPacket& rays, const HitPacket& hits, const double* weight) {
                  for (int lane = 0; lane < kPacketSize; ++lane)
                    if (hits.part[lane] != kNoHit)
                      candidate.unheld.push_back({glm::vec3(hit_point(rays, hits, lane)), {hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]},
                                                  static_cast<float>(weight[lane])});
                });
    for (std::size_t view = 0; view < views_.size(); ++view) drop_held(candidate, view);
    candidates_.push_back(std::move(candidate));
  }
  void add_view(const glm::dvec3& position) {
    views_.push_back(position);
    for (Candidate& candidate : candidates_) drop_held(candidate, views_.size() - 1);
  }
  std::size_t worst() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < candidates_.size(); ++i)
      if (candidates_[i].void_sr > candidates_[best].void_sr) best = i;
    return best;
  }
  double slack() const { return slack_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  const std::vector<glm::dvec3>& views() const { return views_; }

 private:
  // What the view merely grazes stays void: one just below a floor says little to those who walk above it.
  void drop_held(Candidate& candidate, std::size_t view) const {
    const double stretch = largest_stretch(settings_, static_cast<std::uint8_t>(view));
    const auto is_stretched = [&](const Unheld& u) {
      const glm::dvec3 point(u.point), normal(u.normal);
      return slant_density(normal, point - candidate.position) > stretch * slant_density(normal, point - views_[view]);
    };
    farfield::drop_held(scene_, space_, slack_, PointSpacing::kSparse, views_[view], candidate.unheld, is_stretched, [](const Unheld&) {});
    candidate.void_sr = 0;
    for (const Unheld& u : candidate.unheld) candidate.void_sr += u.solid_angle;
  }

  const Scene& scene_;
  const CellSpace& space_;
  const ImpostorSettings& settings_;
  double slack_;
  std::vector<Candidate> candidates_;
  std::vector<glm::dvec3> views_;
};

}  // namespace

glm::dvec3 snap_to_cell(const CellSpace& space, const glm::dvec3& position) {
  constexpr double kSteps = 1024;
  const glm::dvec3 center = space.box.center();
  return center + glm::round((position - center) / space.side_m * kSteps) / kSteps * space.side_m;
}

ShellViews choose_views(const Scene& scene, const CellSpace& space, const ImpostorSettings& settings, ViewSearchWidth width,
                        const std::atomic<bool>* cancel) {
  ShellViews result;
  Standpoints stand = find_standpoints(scene, space.box);
  const glm::dvec3 center = space.box.center();
  const auto nearest_to = [&](const glm::dvec3& target) {
    return *std::min_element(stand.points.begin(), stand.points.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::distance(a, target) < glm::distance(b, target);
    });
  };
  result.positions.push_back(snap_to_cell(space, nearest_to(center)));
  ViewSearch search(scene, space, settings);
  search.add_view(result.positions[0]);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at = center + 0.5 * space.side_m * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    search.add_candidate(snap_to_cell(space, nearest_to(at)));
  }
  const bool is_inner = width == ViewSearchWidth::kInnerCell;
  if (is_inner) {
    for (const glm::dvec3& point : stand.points) search.add_candidate(snap_to_cell(space, point));
    for (int k = 0; k < kScattered; ++k)
      if (const glm::dvec3 point = scattered_point(space.box, k); is_free(scene, point)) search.add_candidate(snap_to_cell(space, point));
  }
  result.first_void_sr = search.candidates().empty() ? 0 : search.candidates()[search.worst()].void_sr;
  const double target = settings.void_target * 4 * 3.14159265358979323846;
  // Nobody can stand in the cell: one view is enough for whoever flies through.
  const int limit = stand.all_blocked ? 0 : std::min<int>(settings.delta_views * (is_inner ? 2 : 1), kMaxDeltaViews);
  result.delta_views_allowed = limit;
  while (static_cast<int>(result.positions.size()) <= limit && !(cancel && cancel->load())) {
    if (result.positions.size() == 3)  // enough sites for a diagram worth having, and cheap enough to try its vertices
      for (const glm::dvec3& vertex : voronoi_vertices(search.views(), space.box))
        if (is_free(scene, vertex)) search.add_candidate(snap_to_cell(space, vertex));
    if (search.candidates().empty()) break;
    const Candidate& worst = search.candidates()[search.worst()];
    if (worst.void_sr <= target) break;
    const glm::dvec3 position = worst.position;
    search.add_view(position);
    result.positions.push_back(position);
  }
  const auto validate = [&](int round) {
    result.validated = count_voids(scene, space, result.positions, search.slack(), round, cancel);
    const double most = settings.targets.void_share * result.validated.rays;
    result.missed_target = settings.targets.void_share > 0 && result.validated.hits > most;
  };
  if (!stand.all_blocked) validate(0);
  for (int round = 1; round <= kRefinements && result.missed_target && static_cast<int>(result.positions.size()) <= limit; ++round) {
    const glm::dvec3 position = snap_to_cell(space, result.validated.worst);
    search.add_view(position);
    result.positions.push_back(position);
    ++result.views_added_by_validation;
    validate(round);
  }
  for (const glm::dvec3& position : result.positions)
    result.warp_gains.push_back(warp_gain((position - center) / space.side_m, settings.kappa));
  for (const Candidate& candidate : search.candidates()) {
    result.void_worst_sr = std::max(result.void_worst_sr, candidate.void_sr);
    result.void_mean_sr += candidate.void_sr / static_cast<double>(search.candidates().size());
  }
  return result;
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/view_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "server/impostor/voronoi.h"

namespace farfield::bench {
namespace {

struct TakenView {
  std::unique_ptr<FarView> view;
  ViewAdjacency adjacency;
};

class Search {
 public:
  Search(double side_m, const ViewSearch& options, const std::function<FarView(const glm::dvec3&)>& cast)
      : side_m_(side_m), options_(options), cast_(cast) {}

  /// Several at once are judged against each other.
  void take(const std::vector<glm::dvec3>& positions) {
    const std::size_t first = taken_.size();
    for (const glm::dvec3& position : positions) taken_.push_back({std::make_unique<FarView>(cast_(position)), {}});
    std::vector<const FarView*> all;
    for (const TakenView& taken : taken_) all.push_back(taken.view.get());
    for (std::size_t k = first; k < taken_.size(); ++k) taken_[k].adjacency = connect_view(*taken_[k].view, all);
    tbb::parallel_for(std::size_t{0}, meters_.size(), [&](std::size_t m) {
      for (std::size_t k = first; k < taken_.size(); ++k) meters_[m].add(*taken_[k].view, taken_[k].adjacency);
    });
  }
  /// Keeps the pictures of candidates that were asked about before.
  void consider(const std::vector<glm::dvec3>& candidates) {
    std::vector<VoidMeter> meters;
    std::vector<std::size_t> fresh;
    for (const glm::dvec3& candidate : candidates) {
      // Candidates are computed anew: a billionth of the cell is far above rounding and far below their distances.
      const auto known = std::find_if(meters_.begin(), meters_.end(),
                                      [&](const VoidMeter& m) { return glm::distance(m.viewpoint(), candidate) < 1e-9 * side_m_; });
      if (known == meters_.end()) fresh.push_back(meters.size());
      meters.push_back(known != meters_.end() ? std::move(*known) : VoidMeter(candidate, side_m_, options_.void_edge));
    }
    meters_ = std::move(meters);
    tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t f) {
      for (const TakenView& taken : taken_) meters_[fresh[f]].add(*taken.view, taken.adjacency);
    });
  }
  std::pair<glm::dvec3, double> worst() const {
    std::pair<glm::dvec3, double> result{glm::dvec3(0), 0};
    for (const VoidMeter& meter : meters_)
      if (const double sr = meter.solid_angle(); sr > result.second) result = {meter.viewpoint(), sr};
    return result;
  }

 private:
  const double side_m_;
  const ViewSearch& options_;
  const std::function<FarView(const glm::dvec3&)>& cast_;
  std::vector<TakenView> taken_;
  std::vector<VoidMeter> meters_;
};

}  // namespace

std::vector<glm::dvec3> planar_candidates(const std::vector<glm::dvec3>& sites, const Box& rectangle) {
  // In a box without height the three-dimensional diagram is the planar one.
  return voronoi_vertices(sites, rectangle);
}

Box eye_rectangle(const Box& box, double eye_height) {
  Box rectangle = box;
  rectangle.min.y = rectangle.max.y = std::clamp(eye_height, box.min.y, box.max.y);
  return rectangle;
}

FoundViews find_views(const Box& rectangle, double side_m, const ViewSearch& search, const std::function<FarView(const glm::dvec3&)>& cast) {
  FoundViews found;
  const glm::dvec3 low = rectangle.min, high = rectangle.max;
  found.positions = {low, {high.x, low.y, low.z}, {low.x, low.y, high.z}, high};
  Search state(side_m, search, cast);
  state.take(found.positions);
  while (true) {
    state.consider(planar_candidates(found.positions, rectangle));
    const auto [position, sr] = state.worst();
    found.worst_void_sr.push_back(sr);
    if (sr <= search.void_sr || found.positions.size() >= search.most_views) return found;
    found.positions.push_back(position);
    state.take({position});
  }
}

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "server/app/path_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace farfield {
namespace {

struct Heading {
  double yaw = 0, pitch = 0;
  glm::dvec3 direction() const { return {-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)}; }
};

struct Steering {
  double curvature = 0;  // 1/m, positive turns left
  double pitch = 0;      // where the arc ends up pointing
  double score = 0;
};

// The end of one arc, and the ways on from there that were not tried yet.
struct Node {
  glm::dvec3 position{0};
  Heading heading;
  std::size_t place_count = 0;      // places on the path up to here
  std::vector<Steering> ways;       // best last
  bool is_opened = false;
};

class Search {
 public:
  Search(const FreeSpace& space, const PathSearchOptions& options, RandomStream random)
      : space_(space), options_(options), random_(random) {}

  Result<std::vector<glm::dvec3>> run(const glm::dvec3& start, double yaw) {
    places_ = {start};
    nodes_.push_back({start, {yaw, 0}, 1, {}, false});
    const std::size_t wanted = static_cast<std::size_t>(std::ceil(options_.length_m / options_.step_m)) + 1;
    const std::size_t most = 400 + 60 * static_cast<std::size_t>(options_.length_m / options_.arc_m + 1);
    for (std::size_t tries = 0; places_.size() < wanted && tries < most; ++tries) {
      if (nodes_.empty()) return fail(ErrorCode::kNotFound, "every way from the starting place is blocked");
      Node& node = nodes_.back();
      if (!node.is_opened) open(node);
      if (node.ways.empty()) {
        nodes_.pop_back();
        continue;
      }
      const Steering way = node.ways.back();
      node.ways.pop_back();
      take(nodes_.size() - 1, way);
    }
    if (places_.size() < wanted) return fail(ErrorCode::kNotFound, "no free path of {:.3g} m found", options_.length_m);
    return std::move(places_);
  }

 private:
  // Rates the ways on: far free sight, little turning, places not seen yet, and chance.
  void open(Node& node) {
    node.is_opened = true;
    const double easy = 1 / options_.easy_radius_m, tight = 1 / options_.tightest_radius_m;
    for (const double curvature : {0.0, 0.2 * easy, -0.2 * easy, 0.5 * easy, -0.5 * easy, easy, -easy, tight, -tight}) {
      for (const double climb : {0.0, 0.35, -0.35}) {
        if (climb != 0 && !options_.climbs) continue;
        Heading end{node.heading.yaw + curvature * options_.arc_m, options_.climbs ? glm::clamp(0.75 * node.heading.pitch + climb, -0.5, 0.5) : 0};
        const glm::dvec3 middle = node.position + 0.5 * options_.arc_m * (node.heading.direction() + end.direction());
        const double free = space_.openness(middle, end.direction(), options_.lookahead_m) / options_.lookahead_m;
        double score = 2.5 * free - 0.5 * std::abs(curvature) * options_.easy_radius_m - 0.8 * std::abs(end.pitch) + 0.5 * random_.unit();
        for (const double ahead : {1.0, 3.0, 5.0}) {
          const auto seen = visits_.find(cell_of(node.position + ahead * options_.arc_m * end.direction()));
          if (seen != visits_.end()) score -= 0.35 * std::min(seen->second, 5);
        }
        node.ways.push_back({curvature, end.pitch, score});
      }
    }
    std::sort(node.ways.begin(), node.ways.end(), [](const Steering& a, const Steering& b) { return a.score < b.score; });
  }

  // Walks the arc place by place; keeps it only if every place is free.
  void take(std::size_t from, const Steering& way) {
    const Node& node = nodes_[from];
    places_.resize(node.place_count);
    const int steps = std::max(1, static_cast<int>(std::lround(options_.arc_m / options_.step_m)));
    glm::dvec3 at = node.position;
    Heading heading = node.heading;
    for (int k = 1; k <= steps; ++k) {
      // Turn half before and half after the step: the chord of the arc.
      const double part = static_cast<double>(k) / steps;
      heading.yaw += 0.5 * way.curvature * options_.step_m;
      heading.pitch = glm::mix(node.heading.pitch, way.pitch, part);
      const std::optional<glm::dvec3> next = space_.settle(at, at + options_.step_m * heading.direction());
      heading.yaw += 0.5 * way.curvature * options_.step_m;
      if (!next) {
        places_.resize(node.place_count);
        return;
      }
      at = *next;
      places_.push_back(at);
    }
    ++visits_[cell_of(at)];
    nodes_.push_back({at, heading, places_.size(), {}, false});
  }

  std::uint64_t cell_of(const glm::dvec3& p) const {
    const glm::dvec3 c = glm::floor(p / (1.5 * options_.arc_m));
    const auto part = [](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) & 0x1fffff; };
    return part(c.x) | part(c.y) << 21 | part(c.z) << 42;
  }

  const FreeSpace& space_;
  PathSearchOptions options_;
  RandomStream random_;
  std::vector<Node> nodes_;
  std::vector<glm::dvec3> places_;
  std::unordered_map<std::uint64_t, int> visits_;
};

}  // namespace

Result<std::vector<glm::dvec3>> search_path(const FreeSpace& space, const glm::dvec3& start, double start_yaw_rad,
                                            const PathSearchOptions& options, RandomStream random) {
  return Search(space, options, random).run(start, start_yaw_rad);
}

}  // namespace farfield

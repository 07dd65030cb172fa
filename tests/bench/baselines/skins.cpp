// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/skins.h"

#include <tbb/parallel_for.h>

namespace farfield::bench {
namespace {

class SkinTests {
 public:
  SkinTests(const FarFace& face, std::span<const FarView* const> others, const SkinLimits& limits)
      : face_(face), others_(others), square_cos_least_(std::pow(std::cos(limits.least_angle_rad), 2)),
        parallax_(static_cast<float>(0.5 * SkinLimits::one_sample(face.frame))) {}

  bool is_skin(int i, int j, Adjacency::Direction d) const {
    const int di = Adjacency::step_i(d), dj = Adjacency::step_j(d);
    const std::size_t a = face_.at(i, j), b = face_.at(i + di, j + dj);
    if (!face_.covered[a] || !face_.covered[b]) return true;  // test 1: at maximum depth
    // Both ends times the product of their disparities, which takes no division and leaves the angle as it is.
    const glm::dvec3 end_a = face_.frame.direction(i, j) * double{face_.disparity[b]};
    const glm::dvec3 end_b = face_.frame.direction(i + di, j + dj) * double{face_.disparity[a]};
    const glm::dvec3 along = end_b - end_a, ray = end_a + end_b;
    const double shadow = glm::dot(along, ray);
    if (shadow * shadow > square_cos_least_ * glm::dot(along, along) * glm::dot(ray, ray)) return true;  // test 2
    if (!is_suspect(i, j, di, dj)) return false;
    const glm::dvec3 middle = 0.5 * (face_.point(i, j) + face_.point(i + di, j + dj));
    for (const FarView* view : others_)
      if (view->position != face_.frame.position && sees_past(*view, middle)) return true;  // test 3
    return false;
  }

 private:
  /// Whether disparity jumps from (i, j) to the next sample: by more than half a sample of parallax beyond what the surface on
  /// either side continues to.
  bool is_suspect(int i, int j, int di, int dj) const {
    const auto at = [&](int steps) { return face_.disparity[face_.at(i + steps * di, j + steps * dj)]; };
    const float step = at(1) - at(0);
    if (std::abs(step) <= parallax_) return false;
    const auto goes_on = [&](int from) {
      if (!face_.holds(i + from * di, j + from * dj) || !face_.holds(i + (from + 1) * di, j + (from + 1) * dj)) return false;
      return std::abs(at(from + 1) - at(from) - step) <= parallax_;
    };
    return !goes_on(-1) && !goes_on(1);
  }

  const FarFace& face_;
  const std::span<const FarView* const> others_;
  const double square_cos_least_;
  const float parallax_;
};

}  // namespace

bool sees_past(const FarView& view, const glm::dvec3& point) {
  const FarFace& face = view.faces[static_cast<std::size_t>(face_towards(view.position, point))];
  const std::optional<FacePlace> place = place_on(face.frame, point);
  if (!place) return false;
  const double beyond = place->disparity - SkinLimits::one_sample(face.frame);
  const int i = static_cast<int>(std::floor(place->i)), j = static_cast<int>(std::floor(place->j));
  for (int dj = 0; dj < 2; ++dj)
    for (int di = 0; di < 2; ++di) {
      if (!face.holds(i + di, j + dj)) return false;
      if (face.disparity[face.at(i + di, j + dj)] >= beyond) return false;
    }
  return true;
}

Adjacency connect_surfaces(const FarFace& face, std::span<const FarView* const> others, const SkinLimits& limits) {
  Adjacency adjacency(face.edge());
  const SkinTests tests(face, others, limits);
  tbb::parallel_for(0, face.edge(), [&](int j) {
    for (int i = 0; i < face.edge(); ++i)
      for (const Adjacency::Direction d : Adjacency::kDirections) {
        if (face.holds(i + Adjacency::step_i(d), j + Adjacency::step_j(d)) && !tests.is_skin(i, j, d)) adjacency.connect(i, j, d);
      }
  });
  return adjacency;
}

}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "server/scene/scene_frame.h"

#include <cmath>

namespace farfield {
namespace {

// At 10⁷ m doubles are 2⁻²⁹ m apart, so bounds carry noise that must not tip a rounding. Model coordinates are most
// often round numbers: moving the tipping point a little away from those keeps the choice stable.
constexpr double kTippingShift = 1.0 / 256;

double longest_edge(const Box& box) {
  const glm::dvec3 e = box.extent();
  const double edge = std::max({e.x, e.y, e.z});
  return edge > 0 ? edge : 1.0;  // a single point: any unit will do
}

}  // namespace

SceneFrame choose_scene_frame(const Box& world_bounds) {
  const double extent = longest_edge(world_bounds) * (1 - kTippingShift);
  const double g = std::min(1.0, std::exp2(std::floor(std::log2(extent / 1024))));
  SceneFrame frame;
  frame.origin = glm::floor(world_bounds.min / g + kTippingShift) * g;
  const double rounded_up = std::exp2(std::ceil(std::log2(extent)));
  frame.step_m = std::max(std::ldexp(rounded_up, -23), std::min(std::ldexp(1.0, -16), std::ldexp(rounded_up, -20)));
  return frame;
}

double mesh_step(const Box& mesh_bounds) {
  return std::ldexp(std::exp2(std::ceil(std::log2(longest_edge(mesh_bounds)))), -21);
}

}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "client/input/walk_camera.h"

#include <algorithm>
#include <cmath>

namespace farfield::client {
namespace {

constexpr double kRadiansPerPixel = 0.0025;
constexpr double kSpeedPerWheelStep = 1.25;
constexpr double kFastFactor = 4;
constexpr double kSlowest = 1e-3, kFastest = 1e4;  // m/s
constexpr double kStraightUp = 1.5707963267948966;

}  // namespace

WalkCamera::WalkCamera(const Pose& start, double speed_m_s) : position_(start.position), speed_m_s_(speed_m_s) {
  const glm::dvec3 looking = start.world_from_camera * glm::dvec3(0, 0, -1);
  pitch_rad_ = std::asin(std::clamp(looking.y, -1.0, 1.0));
  // Looking straight up or down leaves the yaw to the camera's up vector.
  const glm::dvec3 up = start.world_from_camera * glm::dvec3(0, 1, 0);
  const double level = std::hypot(looking.x, looking.z);
  const glm::dvec3 ahead = level > 1e-6 ? looking : (looking.y > 0 ? -up : up);
  yaw_rad_ = std::atan2(-ahead.x, -ahead.z);
}

void WalkCamera::advance(const MoveInput& input, double seconds) {
  yaw_rad_ = std::remainder(yaw_rad_ - kRadiansPerPixel * input.look_right_px, 4 * kStraightUp);
  pitch_rad_ = std::clamp(pitch_rad_ - kRadiansPerPixel * input.look_down_px, -kStraightUp, kStraightUp);
  speed_m_s_ = std::clamp(speed_m_s_ * std::pow(kSpeedPerWheelStep, input.wheel_steps), kSlowest, kFastest);

  const glm::dvec3 level_ahead(-std::sin(yaw_rad_), 0, -std::cos(yaw_rad_));
  const glm::dvec3 right(std::cos(yaw_rad_), 0, -std::sin(yaw_rad_));
  const glm::dvec3 ahead = is_flying_ ? pose().world_from_camera * glm::dvec3(0, 0, -1) : level_ahead;
  glm::dvec3 move = input.forward * ahead + input.right * right + glm::dvec3(0, input.up, 0);
  const double length = glm::length(move);
  if (length > 1) move /= length;  // diagonals are not faster
  position_ += move * (speed_m_s_ * (input.is_fast ? kFastFactor : 1) * seconds);
}

Pose WalkCamera::pose() const {
  return {position_, glm::angleAxis(yaw_rad_, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch_rad_, glm::dvec3(1, 0, 0))};
}

}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "common/predict/motion_filter.h"

#include <cmath>

namespace farfield {
namespace {

// Squared innovation over its variance, three axes: chi-square with 3 degrees of freedom exceeds this once in 10⁵.
constexpr double kManoeuvreGate = 25.9;

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

void MotionFilter::start(const glm::dvec3& position, double time_s) {
  last_time_s_ = time_s;
  last_reported_ = position_ = position;
  velocity_ = glm::dvec3(0);
  var_p_ = settings_.position_sigma_m * settings_.position_sigma_m;
  cov_pv_ = 0;
  var_v_ = settings_.velocity_sigma_m_s * settings_.velocity_sigma_m_s;
}

MotionFilter::Outcome MotionFilter::update(const glm::dvec3& position, double time_s) {
  if (!is_finite(position) || !std::isfinite(time_s)) return Outcome::kIgnored;
  if (!last_time_s_) {
    start(position, time_s);
    return Outcome::kStarted;
  }
  const double dt = time_s - *last_time_s_;
  if (!(dt > 0)) return Outcome::kIgnored;
  const double moved_m = glm::length(position - last_reported_);
  if (dt > settings_.longest_gap_s || moved_m > settings_.jump_speed_m_s * dt) {
    start(position, time_s);
    return Outcome::kStarted;
  }

  // Predict to the time of the pose (eq. 6.2.2-13 for the noise).
  const double q = settings_.acceleration_density;
  position_ += velocity_ * dt;
  var_p_ += dt * (2 * cov_pv_ + dt * var_v_) + q * dt * dt * dt / 3;
  cov_pv_ += dt * var_v_ + q * dt * dt / 2;
  var_v_ += q * dt;

  // A pose the model finds next to impossible: forget the velocity, keep the position.
  const double noise = settings_.position_sigma_m * settings_.position_sigma_m;
  const glm::dvec3 innovation = position - position_;
  Outcome outcome = Outcome::kTracked;
  if (glm::dot(innovation, innovation) > kManoeuvreGate * (var_p_ + noise)) {
    outcome = Outcome::kTurned;
    const double unknown = settings_.velocity_sigma_m_s * settings_.velocity_sigma_m_s;
    var_p_ += dt * dt * unknown;
    cov_pv_ += dt * unknown;
    var_v_ += unknown;
  }

  // Correct by the reported position.
  const double gain_p = var_p_ / (var_p_ + noise);
  const double gain_v = cov_pv_ / (var_p_ + noise);
  position_ += gain_p * innovation;
  velocity_ += gain_v * innovation;
  var_v_ -= gain_v * cov_pv_;
  cov_pv_ *= 1 - gain_p;
  var_p_ *= 1 - gain_p;
  last_time_s_ = time_s;
  last_reported_ = position;
  return outcome;
}

double MotionFilter::velocity_sigma_m_s() const {
  return std::sqrt(var_v_);
}

PredictedPosition MotionFilter::predict(double h) const {
  const double variance = var_p_ + h * (2 * cov_pv_ + h * var_v_) + settings_.acceleration_density * h * h * h / 3;
  return {position_ + velocity_ * h, std::sqrt(variance)};
}

}  // namespace farfield

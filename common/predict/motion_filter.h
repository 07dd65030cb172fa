// SPDX-License-Identifier: Apache-2.0
// Where a viewer will be: a constant-velocity Kalman filter on positions.
//
// In: positions in metres (any one frame), times in seconds of the viewer's own clock, at any rate. Out: the expected
// position some seconds ahead, and how uncertain it is. The state per axis is (position, velocity); acceleration is
// white noise of a given density; the three axes share one covariance because they share all noise.
// Robust: times that do not advance and values that are not finite are ignored; a pause or a jump starts over at
// rest; a turn too sharp for the noise model makes the old velocity forgotten instead of being averaged in.
//
// Based on: Bar-Shalom, Li & Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 6.2
// (white-noise acceleration model) and 11.2 (detecting manoeuvres by the normalised innovation).
// Value type, not thread-safe: one per viewer, on the viewer's own strand.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace farfield {

struct MotionSettings {
  /// Density of acceleration noise, m²/s³: walkers change velocity by about sqrt(q·t) in t seconds, 1.4 m/s in 1 s.
  double acceleration_density = 2.0;
  /// Standard deviation of a reported position about the smooth path, m: the sway of a head.
  double position_sigma_m = 0.01;
  /// Standard deviation of a velocity nothing is known about, m/s.
  double velocity_sigma_m_s = 3.0;
  /// A move that would need more than this is a jump. Above any fly-through, far below any teleport worth the name.
  double jump_speed_m_s = 100.0;
  /// Poses farther apart say nothing about velocity, s.
  double longest_gap_s = 1.0;
};

struct PredictedPosition {
  glm::dvec3 position{0};
  double sigma_m = 0;  // standard deviation along each axis
};

class MotionFilter {
 public:
  explicit MotionFilter(const MotionSettings& settings = {}) : settings_(settings) {}

  enum class Outcome {
    kIgnored,  // nothing changed
    kStarted,  // first position, or the first after a pause or a jump: at rest here
    kTracked,
    kTurned,  // tracked, and the velocity known before was wrong
  };
  Outcome update(const glm::dvec3& position, double time_s);
  void reset() { last_time_s_.reset(); }

  bool has_position() const { return last_time_s_.has_value(); }
  /// Of the last position used. Requires: has_position().
  double time_s() const { return *last_time_s_; }
  glm::dvec3 position() const { return position_; }
  glm::dvec3 velocity() const { return velocity_; }
  /// Standard deviation of the velocity along each axis, m/s.
  double velocity_sigma_m_s() const;
  /// `seconds_ahead` of time_s(). Requires: has_position(), seconds_ahead >= 0.
  PredictedPosition predict(double seconds_ahead) const;

 private:
  void start(const glm::dvec3& position, double time_s);

  MotionSettings settings_;
  std::optional<double> last_time_s_;
  glm::dvec3 last_reported_{0};
  glm::dvec3 position_{0}, velocity_{0};
  double var_p_ = 0, cov_pv_ = 0, var_v_ = 0;  // m², m²/s, m²/s²
};

}  // namespace farfield

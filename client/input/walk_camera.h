// SPDX-License-Identifier: Apache-2.0
// How keys and the mouse move a viewer: yaw and pitch, walking on the horizontal plane or flying where one looks.
// No window needed: a front end fills MoveInput.
#pragma once

#include <glm/glm.hpp>

#include "common/math/camera.h"

namespace farfield::client {

struct MoveInput {
  double forward = 0, right = 0, up = 0;       // -1 … 1
  double look_right_px = 0, look_down_px = 0;  // mouse movement since the last call
  double wheel_steps = 0;                      // up is faster
  bool is_fast = false;                        // 4 times the speed while held
};

class WalkCamera {
 public:
  /// `start`: any frame; its roll is dropped. `speed_m_s` > 0.
  WalkCamera(const Pose& start, double speed_m_s);

  /// Moves for `seconds`. Walking keeps the height unless `up` is asked for; flying follows the view.
  void advance(const MoveInput& input, double seconds);
  void toggle_flying() { is_flying_ = !is_flying_; }

  Pose pose() const;
  double speed_m_s() const { return speed_m_s_; }
  bool is_flying() const { return is_flying_; }

 private:
  glm::dvec3 position_;
  double yaw_rad_ = 0, pitch_rad_ = 0;  // about +Y, then about the camera's X
  double speed_m_s_;
  bool is_flying_ = false;
};

}  // namespace farfield::client

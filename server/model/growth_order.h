// SPDX-License-Identifier: Apache-2.0
// The order in which generated scenes grow: modules of a grid, row by row and column by column around the origin, so
// that whatever the count, the covered area stays close to a square and its extent grows with the root of the count.
#pragma once

#include <glm/glm.hpp>

namespace farfield {

class GrowthOrder {
 public:
  /// `pitch_m`: size of one module along x and z.
  explicit GrowthOrder(glm::dvec2 pitch_m) : pitch_m_(pitch_m) {}

  /// Grid coordinates of the next module; the first is (0, 0).
  glm::ivec2 next() {
    if (at_ == length_) start_side();
    glm::ivec2 module = first_;
    module[grows_x_ ? 1 : 0] += at_++;
    return module;
  }

 private:
  // Adds a whole column or row on the side that keeps the rectangle squarest, alternating between both ends.
  void start_side() {
    const glm::ivec2 size = high_ - low_;
    if (size.x == 0) {
      high_ = {1, 1};
      first_ = {0, 0};
      grows_x_ = true;
      length_ = 1;
    } else {
      grows_x_ = size.x * pitch_m_.x <= size.y * pitch_m_.y;
      const int axis = grows_x_ ? 0 : 1;
      first_ = low_;
      if (size[axis] % 2 == 1) {
        first_[axis] = high_[axis]++;
      } else {
        first_[axis] = --low_[axis];
      }
      length_ = size[1 - axis];
    }
    at_ = 0;
  }

  glm::dvec2 pitch_m_;
  glm::ivec2 low_{0}, high_{0};  // half-open rectangle of modules begun
  glm::ivec2 first_{0};
  bool grows_x_ = true;
  int at_ = 0, length_ = 0;
};

}  // namespace farfield

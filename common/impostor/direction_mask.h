// SPDX-License-Identifier: Apache-2.0
// A coarse set of directions: one bit for each of 32×32 squares of each cube face. It tells a client where the
// background can be seen from a leaf, so that a void elsewhere is never filled with the sky.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "common/base/bytes.h"
#include "common/math/camera.h"
#include "common/math/cube_face.h"

namespace farfield {

class DirectionMask {
 public:
  static constexpr int kEdge = 32;
  static constexpr std::size_t kBytes = kCubeFaces * kEdge * kEdge / 8;

  static DirectionMask all() {
    DirectionMask mask;
    mask.bits_.fill(0xff);
    return mask;
  }
  /// Returns: the mask of these bytes; all directions if there are not exactly kBytes.
  static DirectionMask from_bytes(ByteView bytes) {
    if (bytes.size() != kBytes) return all();
    DirectionMask mask;
    std::copy(bytes.begin(), bytes.end(), mask.bits_.begin());
    return mask;
  }
  ByteView bytes() const { return bits_; }

  void insert(const glm::dvec3& direction) {
    const int bit = bit_of(direction);
    bits_[bit / 8] |= static_cast<std::uint8_t>(1u << (bit % 8));
  }
  void insert(const DirectionMask& other) {
    for (std::size_t i = 0; i < kBytes; ++i) bits_[i] |= other.bits_[i];
  }
  bool contains(const glm::dvec3& direction) const { return has(bit_of(direction)); }

  /// What holds for every direction of the pyramid between four.
  enum class Share { kNone, kAll, kUnknown };
  Share share_between(const std::array<glm::dvec3, 4>& corners) const {
    int low_row = kEdge, high_row = 0, low_column = kEdge, high_column = 0;
    const int face = bit_of(corners[0]) / (kEdge * kEdge);
    for (const glm::dvec3& corner : corners) {
      const int bit = bit_of(corner), row = bit / kEdge % kEdge, column = bit % kEdge;
      if (bit / (kEdge * kEdge) != face) return Share::kUnknown;
      low_row = std::min(low_row, row), high_row = std::max(high_row, row);
      low_column = std::min(low_column, column), high_column = std::max(high_column, column);
    }
    // A face is a convex cone and its squares are rectangles in it: what lies between the corners lies in these.
    const bool first = has((face * kEdge + low_row) * kEdge + low_column);
    for (int row = low_row; row <= high_row; ++row) {
      for (int column = low_column; column <= high_column; ++column)
        if (has((face * kEdge + row) * kEdge + column) != first) return Share::kUnknown;
    }
    return first ? Share::kAll : Share::kNone;
  }

 private:
  bool has(int bit) const { return bits_[bit / 8] >> (bit % 8) & 1; }
  static int bit_of(const glm::dvec3& direction) {
    const int face = dominant_face(direction);
    const CubeFace frame = CubeFace::of(face);
    const double scale = 1.0 / std::abs(direction[frame.axis]);
    const auto place = [](double t) { return std::clamp(static_cast<int>((t + 1) * 0.5 * kEdge), 0, kEdge - 1); };
    return (face * kEdge + place(direction[frame.v_axis()] * scale)) * kEdge + place(direction[frame.u_axis()] * scale);
  }
  std::array<std::uint8_t, kBytes> bits_{};
};

/// Whether a pixel that nothing covers may show the background: asked for every open pixel of every frame.
class SkyTest {
 public:
  SkyTest() : SkyTest(DirectionMask(), glm::dmat3(1), Display()) {}
  SkyTest(const DirectionMask& mask, const glm::dmat3& world_from_camera, const Display& display)
      : mask_(mask),
        first_(world_from_camera * camera_direction(display, 0.5, 0.5)),
        per_column_(world_from_camera * (camera_direction(display, 1.5, 0.5) - camera_direction(display, 0.5, 0.5))),
        per_row_(world_from_camera * (camera_direction(display, 0.5, 1.5) - camera_direction(display, 0.5, 0.5))) {}

  bool may_be_sky(int x, int y) const { return mask_.contains(direction(x, y)); }
  /// Which of the pixels [left, right] × [top, bottom] may be: some, if not known.
  DirectionMask::Share share_of_sky(int left, int right, int top, int bottom) const {
    return mask_.share_between({direction(left, top), direction(right, top), direction(left, bottom), direction(right, bottom)});
  }

 private:
  glm::dvec3 direction(int x, int y) const {
    return first_ + static_cast<double>(x) * per_column_ + static_cast<double>(y) * per_row_;
  }

  DirectionMask mask_;
  glm::dvec3 first_, per_column_, per_row_;  // the top left pixel's direction and its steps
};

}  // namespace farfield

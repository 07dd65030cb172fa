// SPDX-License-Identifier: Apache-2.0
// Which neighbouring samples of a range image belong to one surface: everywhere else a connection would be a skin, a
// surface that is not in the scene.
//
// Based on: Wilson & Manocha 2003, section 3.3.3, the three tests of figure 4, for all eight neighbours of a sample.
// Differs: test 3 is asked only of connections that jump by more than half a sample of parallax somewhere in the cell from what
// the surfaces at their ends continue to: behind less nothing wider can hide, and in most scenes that leaves one
// connection in a hundred. "Beyond" there means: all four samples around the midpoint are farther by more than one sample
// of parallax, so that the other view's own grid makes no skins.
#pragma once

#include <span>

#include "tests/bench/baselines/far_view.h"

namespace farfield::bench {

/// Connections of a face's samples with their neighbours, each kept at its upper or left end.
class Adjacency {
 public:
  explicit Adjacency(int edge) : edge_(edge), bits_(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge), 0) {}

  enum Direction : std::uint8_t { kRight = 1, kDown = 2, kDownRight = 4, kDownLeft = 8 };
  static constexpr Direction kDirections[4] = {kRight, kDown, kDownRight, kDownLeft};
  static int step_i(Direction d) { return d == kDown ? 0 : d == kDownLeft ? -1 : 1; }
  static int step_j(Direction d) { return d == kRight ? 0 : 1; }

  /// False for samples or neighbours outside the face.
  bool is_connected(int i, int j, Direction d) const {
    return i >= 0 && j >= 0 && i < edge_ && j < edge_ && (bits_[at(i, j)] & d) != 0;
  }
  void connect(int i, int j, Direction d) { bits_[at(i, j)] |= d; }
  int edge() const { return edge_; }

 private:
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(edge_) + static_cast<std::size_t>(i); }
  int edge_;
  std::vector<std::uint8_t> bits_;
};

struct SkinLimits {
  /// Test 2's α, below which a connection runs along the line of sight. The paper names none. A jump of Δz between samples
  /// h apart at distance z is seen under atan(z·h/Δz), a floor at height e under atan(e/z): 1.5° tells jumps above 0.7 m
  /// at 10 m (1250 samples a face) from floors up to 65 m away, and test 3 sees to the rest.
  double least_angle_rad = 1.5 * 3.14159265358979323846 / 180;
  /// Test 3's tolerance in disparity, 1/side: what moves a point by one sample somewhere in the cell (common/cells/sampling.h:
  /// K is 2.4 for a view at a corner).
  static double one_sample(const ViewFrame& frame) { return frame.pitch / 2.4; }
};

/// `others`: the views test 3 asks; the face's own among them does no harm.
Adjacency connect_surfaces(const FarFace& face, std::span<const FarView* const> others, const SkinLimits& limits = {});

/// Whether `view` sees past a point to something farther, or to nothing.
bool sees_past(const FarView& view, const glm::dvec3& point);

}  // namespace farfield::bench

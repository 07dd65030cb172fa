// SPDX-License-Identifier: Apache-2.0
// A small scene with two depth layers, and pictures of it, for the tests of the baselines.
#pragma once

#include <random>

#include "server/scene/reference_image.h"
#include "tests/bench/baselines/baseline_frame.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield::test {

/// A room of 8 m with a pillar outside the near region of a 1 m cell at the origin; nothing is near.
struct PillarRoom {
  PlacedScene placed = pillar_room().build();
  CellSpace space = space_around(placed, {0, 0, 0}, 1.0);

  const Scene& scene() const { return *placed.scene; }
  glm::dvec3 centre() const { return space.box.center(); }
  glm::dvec3 random_eye(std::mt19937& random) const {
    std::uniform_real_distribution<double> inside(-0.49, 0.49);
    return centre() + glm::dvec3(inside(random), inside(random), inside(random));
  }
};

inline const Display kFarDisplay{160, 120, 1.2};

/// Looking along +X, where the pillar stands.
inline Pose towards_pillar(const glm::dvec3& eye) { return {eye, glm::angleAxis(-1.5707963267948966, glm::dvec3(0, 1, 0))}; }

inline client::LeafView empty_near(const CellSpace& space, const Scene& scene) {
  client::LeafView near;
  near.leaf_box = space.box, near.near_region = space.shell.inside;
  near.is_complete = true, near.background = scene.background();
  return near;
}

/// Mean absolute difference of 8-bit colours, and the share of pixels off by more than 12 in some channel.
struct Difference {
  double mean = 0, wrong_share = 0;
};
inline Difference difference(const client::Frame& seen, const ReferenceImage& wanted) {
  Difference d;
  for (std::size_t k = 0; k < seen.pixels(); ++k) {
    int worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int off = std::abs(int{seen.rgba[4 * k + c]} - int{wanted.rgb[3 * k + c]});
      d.mean += off / (3.0 * static_cast<double>(seen.pixels())), worst = std::max(worst, off);
    }
    d.wrong_share += (worst > 12) / static_cast<double>(seen.pixels());
  }
  return d;
}

/// Draws an impostor alone and compares it with the scene.
class FarComparison {
 public:
  explicit FarComparison(const PillarRoom& room) : room_(room), renderer_(bench::BaselineFrame::create(kFarDisplay, 1).value()) {}
  template <class... Impostor>
  void show(const Impostor&... impostor) {
    renderer_->show(impostor...);
  }
  Difference at(const glm::dvec3& eye) {
    const client::LeafView near = empty_near(room_.space, room_.scene());
    drawn = renderer_->draw(near, towards_pillar(eye), frame);
    return difference(frame, render_reference(room_.scene(), towards_pillar(eye), kFarDisplay, 1));
  }
  double uncovered_share() const {
    const auto covered = std::count(frame.coverage.begin(), frame.coverage.end(), client::Coverage::kImpostor);
    return 1 - static_cast<double>(covered) / static_cast<double>(frame.pixels());
  }
  client::Frame frame;
  bench::BaselineDrawn drawn;

 private:
  const PillarRoom& room_;
  std::unique_ptr<bench::BaselineFrame> renderer_;
};

}  // namespace farfield::test

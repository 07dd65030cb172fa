// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/void_surface.h"

#include <gtest/gtest.h>

#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

// Skins are a sample wide even where nothing is hidden: bands along both sides of the pillar, which is 110 degrees high.
constexpr int kEdge = 258;
constexpr double kRims = 2 * 1.64 * 2.0 / (kEdge - 2);

class VoidSurfaceTest : public testing::Test {
 protected:
  FarView cast(const glm::dvec3& position) const { return cast_far_view(room.scene(), room.space, position, kEdge); }
  void add(const glm::dvec3& position, VoidMeter& meter) const {
    const FarView view = cast(position);
    meter.add(view, connect_view(view, {}));
  }
  /// The solid angle of what an eye sees and a sample does not, point by point.
  double hidden(const FarView& sample, const glm::dvec3& eye) const {
    const FarView seen = cast(eye);
    double sum = 0;
    for (const FarFace& face : seen.faces)
      for (int j = 1; j + 1 < kEdge; ++j)
        for (int i = 1; i + 1 < kEdge; ++i) {
          const glm::dvec3 point = face.point(i, j);
          const FarFace& other = sample.faces[static_cast<std::size_t>(face_towards(sample.position, point))];
          const FacePlace place = place_on(other.frame, point).value();
          const auto index = [](double at) { return std::clamp(static_cast<int>(std::lround(at)), 0, kEdge - 1); };
          const std::size_t nearest = other.at(index(place.i), index(place.j));
          if (other.disparity[nearest] - place.disparity > 0.02) sum += sample_solid_angle(face.frame.u(i), face.frame.u(j), face.frame.pitch);
        }
    return sum;
  }
  test::PillarRoom room;
};

TEST_F(VoidSurfaceTest, ASampleKnowsAllThatIsSeenFromWhereItStands) {
  VoidMeter meter(room.centre(), 1.0, 200);
  add(room.centre(), meter);
  EXPECT_LT(meter.solid_angle(), 1.5 * kRims);
}

TEST_F(VoidSurfaceTest, IsAsLargeAsWhatTheSampleDoesNotSee) {
  for (const double z : {-0.45, 0.3, 0.45}) {
    VoidMeter meter(room.centre() + glm::dvec3(0.1, 0.05, z), 1.0, 200);
    add(room.centre(), meter);
    const double wanted = hidden(cast(room.centre()), meter.viewpoint());
    EXPECT_GT(wanted, 0.03);
    EXPECT_GT(meter.solid_angle(), 0.9 * wanted);
    EXPECT_LT(meter.solid_angle(), wanted + 1.5 * kRims);
  }
}

TEST_F(VoidSurfaceTest, FallsWithEachSampleAndVanishesWithOneThatSeesIt) {
  std::mt19937 random(5);
  for (int eye = 0; eye < 3; ++eye) {
    VoidMeter meter(room.random_eye(random), 1.0, 200);
    add(room.centre(), meter);
    double before = meter.solid_angle();
    for (int k = 0; k < 3; ++k) {
      add(room.random_eye(random), meter);
      EXPECT_LE(meter.solid_angle(), before);
      before = meter.solid_angle();
    }
    add(meter.viewpoint(), meter);
    EXPECT_LT(meter.solid_angle(), 1.5 * kRims);
  }
}

}  // namespace
}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/video_schedule.h"

#include <gtest/gtest.h>

#include "tests/bench/baselines/rotation_warp.h"

namespace farfield::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Straight on at 1.4 m/s while turning about the vertical axis.
Trace walk(double seconds, double turn_rad_s) {
  Trace trace;
  for (int k = 0; k <= std::lround(60 * seconds); ++k) {
    const double t = k / 60.0;
    trace.frames.push_back({10 + t, {{1.4 * t, 1.7, 0}, glm::angleAxis(turn_rad_s * t, glm::dvec3(0, 1, 0))}});
  }
  return trace;
}

double angle_deg(const glm::dquat& a, const glm::dquat& b) {
  return 2 * std::acos(std::min(1.0, std::abs(glm::dot(a, b)))) * 180 / kPi;
}

TEST(VideoSchedule, OneStreamWhereSampledFramesAreDense) {
  const Trace trace = walk(4, 0);
  const VideoSchedule schedule = make_video_schedule(trace, 9, 30, 0);  // every half second
  EXPECT_NEAR(schedule.interval_s, 1.0 / 30, 1e-12);
  EXPECT_EQ(schedule.pictures.size(), 30u + 121u);
  int firsts = 0, judged = 0;
  for (std::size_t k = 0; k < schedule.pictures.size(); ++k) {
    const VideoPicture& picture = schedule.pictures[k];
    firsts += picture.is_first;
    EXPECT_EQ(picture.is_before_walk, k < 30);
    if (picture.judged < 0) continue;
    EXPECT_EQ(picture.judged, judged++);
    EXPECT_NEAR(picture.shown.position.x, 1.4 * 0.5 * picture.judged, 1e-9);
  }
  EXPECT_EQ(firsts, 1);
  EXPECT_EQ(judged, 9);
}

TEST(VideoSchedule, ASecondBeforeEachWhereTheyAreFarApart) {
  const VideoSchedule schedule = make_video_schedule(walk(10, 0), 3, 30, 0);  // every five seconds
  EXPECT_EQ(schedule.pictures.size(), 3 * 31u);
  for (std::size_t k = 0; k < schedule.pictures.size(); ++k) {
    EXPECT_EQ(schedule.pictures[k].is_first, k % 31 == 0);
    EXPECT_EQ(schedule.pictures[k].judged, k % 31 == 30 ? static_cast<int>(k / 31) : -1);
  }
  EXPECT_EQ(make_video_schedule(walk(10, 0), 1, 60, 0).pictures.size(), 61u);
}

TEST(VideoSchedule, WithoutALinkThePredictionIsExactAndNothingIsWidened) {
  const VideoSchedule schedule = make_video_schedule(walk(3, 2), 4, 30, video_delay_s({}));
  EXPECT_EQ(schedule.margin_rad, 0);
  const Display display{1280, 720};
  EXPECT_EQ(schedule.rendered(display).width, 1280);
  EXPECT_EQ(schedule.rendered(display).height, 720);
  EXPECT_NEAR(schedule.rendered(display).pixel_pitch(), display.pixel_pitch(), 1e-15);
  for (const VideoPicture& picture : schedule.pictures) {
    EXPECT_EQ(picture.predicted.position, picture.shown.position);
    EXPECT_EQ(picture.predicted.world_from_camera, picture.shown.world_from_camera);
  }
}

TEST(VideoSchedule, SteadyMotionIsPredictedAndATurnNeedsAMargin) {
  const double delay = video_delay_s({.delay = std::chrono::milliseconds(50), .jitter = std::chrono::milliseconds(20)});
  EXPECT_NEAR(delay, 0.13, 1e-12);
  const VideoSchedule steady = make_video_schedule(walk(4, 1), 9, 30, delay);
  EXPECT_LT(angle_deg(steady.pictures.back().predicted.world_from_camera, steady.pictures.back().shown.world_from_camera), 0.01);
  EXPECT_LT(glm::distance(steady.pictures.back().predicted.position, steady.pictures.back().shown.position), 0.01);
  // At first the viewer stands still, so the first steps come as a surprise.
  EXPECT_GT(steady.margin_rad, 0.01);
  EXPECT_LT(steady.margin_rad, 0.2);
  const Display display{1280, 720}, wide = steady.rendered(display);
  EXPECT_GT(wide.width, 1280);
  EXPECT_EQ(wide.width % 2 + wide.height % 2, 0);
  EXPECT_NEAR(wide.pixel_pitch(), display.pixel_pitch(), 1e-12);
}

// A picture whose colour is a smooth function of the world's direction.
std::vector<std::uint8_t> picture_of_directions(const Display& display, const glm::dquat& world_from_camera) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < display.height; ++y)
    for (int x = 0; x < display.width; ++x) {
      const glm::dvec3 d = glm::normalize(world_from_camera * camera_direction(display, x + 0.5, y + 0.5));
      for (int c = 0; c < 3; ++c) rgb.push_back(static_cast<std::uint8_t>(std::lround(127.5 + 120 * d[c])));
    }
  return rgb;
}

TEST(RotationWarp, ShowsEveryDirectionInItsColour) {
  const Display shown{160, 90}, wide{240, 180, 2 * std::atan(2 * std::tan(kPi / 6))};
  const glm::dquat before = glm::angleAxis(0.4, glm::normalize(glm::dvec3(1, 2, 0.3)));
  const glm::dquat now = glm::angleAxis(0.12, glm::normalize(glm::dvec3(0.2, 1, 0.5))) * before;
  const auto warped = warp_by_rotation(picture_of_directions(wide, before), wide, before, shown, now);
  const auto wanted = picture_of_directions(shown, now);
  for (std::size_t i = 0; i < wanted.size(); ++i) ASSERT_NEAR(warped[i], wanted[i], 2) << i;
}

TEST(RotationWarp, OntoItselfChangesNothing) {
  const Display display{64, 48};
  const glm::dquat rotation = glm::angleAxis(1.0, glm::dvec3(0, 1, 0));
  const auto picture = picture_of_directions(display, rotation);
  EXPECT_EQ(warp_by_rotation(picture, display, rotation, display, rotation), picture);
}

}  // namespace
}  // namespace farfield::bench

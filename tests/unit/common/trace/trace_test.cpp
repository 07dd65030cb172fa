// SPDX-License-Identifier: Apache-2.0
#include "common/trace/trace.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <random>

#include "common/trace/trace_file.h"

namespace farfield {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Half a turn about y while walking 10 m along x in 2 s, 1e7 m from the origin.
Trace walk() {
  Trace trace;
  trace.scene = "pipes:1000:1";
  for (int i = 0; i <= 120; ++i) {
    const double s = i / 120.0;
    trace.frames.push_back({5 + 2 * s, {{1e7 + 10 * s, 1.7, -3e6 / 7}, glm::angleAxis(kPi * s, glm::dvec3(0, 1, 0))}});
  }
  return trace;
}

TEST(Trace, RoundTripThroughTextIsExact) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> far(-1e7, 1e7), small(-1, 1);
  Trace trace;
  trace.scene = "city:1:2";
  for (int i = 0; i < 500; ++i) {
    const glm::dquat q = glm::normalize(glm::dquat(small(random), small(random), small(random), small(random)));
    trace.frames.push_back({i / 60.0, {{far(random), far(random) * 1e-9, far(random)}, q}});
  }
  const Result<Trace> back = parse_trace(format_trace(trace), "memory");
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->scene, trace.scene);
  ASSERT_EQ(back->frames.size(), trace.frames.size());
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    EXPECT_EQ(back->frames[i].time_s, trace.frames[i].time_s);
    EXPECT_EQ(back->frames[i].pose.position, trace.frames[i].pose.position);
    EXPECT_EQ(back->frames[i].pose.world_from_camera, trace.frames[i].pose.world_from_camera);
  }
}

TEST(Trace, FileRoundTripLeavesNothingBeside) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / fmt::format("trace_test_{}", ::getpid());
  std::filesystem::create_directories(folder);
  const std::filesystem::path path = folder / "walk.txt";
  ASSERT_TRUE(write_trace(path, walk()).has_value());
  ASSERT_TRUE(write_trace(path, walk()).has_value());  // over an existing file
  const Result<Trace> back = read_trace(path);
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->frames.size(), 121u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(read_trace(path).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(write_trace(path, walk()).error().code, ErrorCode::kIo);
}

TEST(Trace, PlainTumFilesAreRead) {
  const Result<Trace> trace = parse_trace("# ground truth trajectory\n# file: 'a.bag'\n\n0.5 1 2 3 0 0 0 1\r\n 1.5\t4 5 6 0 0 0 -2e0\n", "tum");
  EXPECT_FALSE(trace.has_value());  // a quaternion of length 2 is no rotation
  const Result<Trace> good = parse_trace("# x\n0.5 1 2 3 0 0 0 1.0001\r\n 1.5\t4 5 6 0 1 0 0", "tum");
  ASSERT_TRUE(good.has_value()) << good.error().message;
  ASSERT_EQ(good->frames.size(), 2u);
  EXPECT_NEAR(glm::length(good->frames[0].pose.world_from_camera), 1, 1e-15);
  EXPECT_EQ(good->frames[1].pose.position, glm::dvec3(4, 5, 6));
}

TEST(Trace, ErrorsNameTheLine) {
  const auto message = [](std::string_view text) {
    const Result<Trace> trace = parse_trace(text, "f.txt");
    return trace ? std::string("(none)") : trace.error().message;
  };
  EXPECT_EQ(message("0 1 2 3 0 0 0 1\n1 1 2 x3 0 0 0 1\n"), "f.txt:2: \"x3\" is not a number");
  EXPECT_NE(message("0 1 2 3 0 0 0\n").find("f.txt:1: 7 numbers"), std::string::npos);
  EXPECT_NE(message("0 1 2 3 0 0 0 1 9\n").find("f.txt:1: more than 8"), std::string::npos);
  EXPECT_NE(message("0 1 2 3 0 0 0 1\n\n0 1 2 3 0 0 0 1\n").find("f.txt:3: time 0 does not follow 0"), std::string::npos);
  EXPECT_NE(message("0 nan 2 3 0 0 0 1\n").find("f.txt:1: number 2"), std::string::npos);
  EXPECT_NE(message("0 1 2 1e300 0 0 0 1\n").find("f.txt:1: number 4"), std::string::npos);
  EXPECT_NE(message("0 1 2 3 0 0 0 0\n").find("not a rotation"), std::string::npos);
  EXPECT_NE(message("# frame: scene\n").find("f.txt:1: frame \"scene\""), std::string::npos);
  EXPECT_NE(message("# units: feet\n").find("f.txt:1: units \"feet\""), std::string::npos);
  EXPECT_NE(message("# nothing\n").find("no frames"), std::string::npos);
  EXPECT_NE(message(std::string("0 1 2 3 0 0 0 \0", 15)).find("not a number"), std::string::npos);
}

TEST(Trace, PoseAtInterpolatesAndClamps) {
  const Trace trace = walk();
  const Pose middle = pose_at(trace, 6 + 1.0 / 240);
  EXPECT_NEAR(middle.position.x - 1e7, 10 * (0.5 + 1.0 / 480), 1e-8);
  const glm::dvec3 ahead = middle.world_from_camera * glm::dvec3(0, 0, -1);
  const double angle = kPi * (0.5 + 1.0 / 480);
  EXPECT_NEAR(glm::distance(ahead, glm::dvec3(-std::sin(angle), 0, -std::cos(angle))), 0, 1e-9);
  EXPECT_EQ(pose_at(trace, -1).position, trace.frames.front().pose.position);
  EXPECT_EQ(pose_at(trace, 99).position, trace.frames.back().pose.position);
}

TEST(Trace, InterpolationTakesTheShorterArc) {
  Trace trace = walk();
  for (std::size_t i = 0; i < trace.frames.size(); i += 2) {
    trace.frames[i].pose.world_from_camera = -trace.frames[i].pose.world_from_camera;  // the same rotation
  }
  const glm::dquat a = pose_at(trace, 6.004).world_from_camera, b = pose_at(walk(), 6.004).world_from_camera;
  EXPECT_NEAR(std::abs(glm::dot(a, b)), 1, 1e-12);
}

TEST(Trace, ResampledKeepsEndsAndSpacing) {
  const Result<Trace> trace = resampled(walk(), 7);
  ASSERT_TRUE(trace.has_value());
  ASSERT_EQ(trace->frames.size(), 7u);
  EXPECT_EQ(trace->frames.back().time_s, 7.0);
  EXPECT_EQ(trace->frames.back().pose.position, walk().frames.back().pose.position);
  EXPECT_NEAR(trace->frames[3].time_s, 6, 1e-12);
  EXPECT_NEAR(length_of(*trace), 10, 1e-7);
  const Result<Trace> first = resampled(walk(), 1);
  ASSERT_TRUE(first.has_value());
  ASSERT_EQ(first->frames.size(), 1u);
  EXPECT_EQ(first->frames[0].time_s, walk().frames.front().time_s);
  EXPECT_FALSE(resampled(walk(), 0).has_value());
  EXPECT_FALSE(resampled(Trace{}, 5).has_value());
}

TEST(Trace, SummaryMatchesTheWalk) {
  const TraceSummary summary = summarise(walk());
  EXPECT_EQ(summary.frames, 121u);
  EXPECT_NEAR(summary.seconds, 2, 1e-12);
  EXPECT_NEAR(summary.length_m, 10, 1e-7);
  EXPECT_NEAR(summary.speed_mean_m_s, 5, 1e-6);
  EXPECT_NEAR(summary.speed_p95_m_s, 5, 1e-5);
  EXPECT_NEAR(summary.turn_p95_rad_s, kPi / 2, 1e-6);
  EXPECT_NEAR(summary.bounds.extent().x, 10, 1e-8);
  EXPECT_EQ(summarise(Trace{}).length_m, 0);
}

}  // namespace
}  // namespace farfield

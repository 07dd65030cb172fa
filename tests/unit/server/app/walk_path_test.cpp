// SPDX-License-Identifier: Apache-2.0
// Generated traces against the scene itself: room around every eye, floor below it, even speed, gentle turns.
#include "server/app/walk_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "server/app/trace_map.h"
#include "server/model/generate.h"

namespace farfield {
namespace {

std::shared_ptr<const Scene> scene_of(const std::string& kind, std::size_t triangles) {
  Result<Model> model = generate_model(kind, triangles, 1);
  EXPECT_TRUE(model.has_value());
  Result<std::shared_ptr<const Scene>> scene = Scene::build(std::move(*model));
  EXPECT_TRUE(scene.has_value());
  return *scene;
}

/// Distance to the nearest of many rays' hits about `center`, at most `reach`; independent of the generator's own rays.
double nearest_hit(const Scene& scene, const glm::dvec3& center, double reach) {
  constexpr int kRays = 256;
  double nearest = reach;
  for (int first = 0; first < kRays; first += kPacketSize) {
    RayPacket rays{};
    HitPacket hits{};
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const double y = 1 - (2.0 * (first + lane) + 1) / kRays, angle = 2.399963 * (first + lane) + 0.3, r = std::sqrt(1 - y * y);
      rays.origin_x[lane] = static_cast<float>(center.x);
      rays.origin_y[lane] = static_cast<float>(center.y);
      rays.origin_z[lane] = static_cast<float>(center.z);
      rays.direction_x[lane] = static_cast<float>(r * std::cos(angle));
      rays.direction_y[lane] = static_cast<float>(y);
      rays.direction_z[lane] = static_cast<float>(r * std::sin(angle));
      rays.near[lane] = 0;
      rays.far[lane] = static_cast<float>(reach);
    }
    scene.intersect_scattered(rays, hits);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (hits.part[lane] != kNoHit) nearest = std::min(nearest, static_cast<double>(hits.distance[lane]));
    }
  }
  return nearest;
}

double floor_distance(const Scene& scene, const glm::dvec3& eye) {
  RayPacket rays{};
  HitPacket hits{};
  rays.active = 1;
  rays.origin_x[0] = static_cast<float>(eye.x);
  rays.origin_y[0] = static_cast<float>(eye.y);
  rays.origin_z[0] = static_cast<float>(eye.z);
  rays.direction_y[0] = -1;
  rays.far[0] = 10;
  scene.intersect_scattered(rays, hits);
  return hits.part[0] == kNoHit ? 10 : hits.distance[0];
}

// Speed between successive frames stays within 5 % of `speed`, away from the eased half seconds at both ends.
void expect_even_speed(const Trace& trace, double speed) {
  for (std::size_t i = 31; i + 31 < trace.frames.size(); ++i) {
    const TraceFrame &a = trace.frames[i - 1], &b = trace.frames[i];
    ASSERT_NEAR(glm::distance(a.pose.position, b.pose.position) / (b.time_s - a.time_s), speed, 0.05 * speed) << "frame " << i;
  }
}

class Walk : public testing::TestWithParam<const char*> {};

TEST_P(Walk, TouchesNothingAndKeepsItsPace) {
  const auto scene = scene_of(GetParam(), 150'000);
  for (const std::uint64_t seed : {1u, 2u}) {
    TraceOptions options;
    options.seconds = 10;
    options.seed = seed;
    std::string note;
    const Result<Trace> trace = generate_trace(*scene, options, &note);
    ASSERT_TRUE(trace.has_value()) << trace.error().message;
    EXPECT_EQ(note, "");
    ASSERT_EQ(trace->frames.size(), 601u);
    expect_even_speed(*trace, 1.4);
    double slowest_floor = 10, highest_floor = 0;
    for (std::size_t i = 0; i < trace->frames.size(); i += 3) {
      const glm::dvec3 eye = trace->frames[i].pose.position - scene->origin();
      ASSERT_GE(nearest_hit(*scene, eye, 0.5), 0.25) << "seed " << seed << " frame " << i;
      const double below = floor_distance(*scene, eye);
      slowest_floor = std::min(slowest_floor, below);
      highest_floor = std::max(highest_floor, below);
    }
    EXPECT_GT(slowest_floor, 1.4);
    EXPECT_LT(highest_floor, 2.0);
    EXPECT_LT(summarise(*trace).turn_p95_rad_s, 3.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Walk, testing::Values("pipes", "city", "statues", "house"),
                         [](const auto& info) { return std::string(info.param); });

TEST(WalkPath, SameSeedSamePathOtherSeedOtherPath) {
  const auto scene = scene_of("pipes", 100'000);
  TraceOptions options;
  options.seconds = 3;
  const auto end_of = [&](std::uint64_t seed) {
    options.seed = seed;
    return generate_trace(*scene, options)->frames.back().pose.position;
  };
  EXPECT_EQ(end_of(4), end_of(4));
  EXPECT_NE(end_of(4), end_of(5));
}

TEST(WalkPath, FlightsKeepTheirDistance) {
  const auto scene = scene_of("city", 150'000);
  TraceOptions options;
  options.kind = TraceKind::kFly;
  options.seconds = 10;
  const Result<Trace> trace = generate_trace(*scene, options);
  ASSERT_TRUE(trace.has_value()) << trace.error().message;
  expect_even_speed(*trace, 4);
  for (std::size_t i = 0; i < trace->frames.size(); i += 6) {
    ASSERT_GE(nearest_hit(*scene, trace->frames[i].pose.position - scene->origin(), 1), 0.4) << "frame " << i;
  }
}

TEST(WalkPath, OrbitsLookAtTheMiddle) {
  const auto scene = scene_of("statues", 20'000);
  TraceOptions options;
  options.kind = TraceKind::kOrbit;
  options.seconds = 8;
  const Result<Trace> trace = generate_trace(*scene, options);
  ASSERT_TRUE(trace.has_value());
  const glm::dvec3 middle = scene->bounds().center() + scene->origin();
  for (const TraceFrame& frame : trace->frames) {
    const glm::dvec3 ahead = frame.pose.world_from_camera * glm::dvec3(0, 0, -1);
    EXPECT_NEAR(glm::dot(ahead, glm::normalize(middle - frame.pose.position)), 1, 1e-9);
  }
  EXPECT_NEAR(glm::distance(trace->frames.front().pose.position, trace->frames.back().pose.position), 0, 1e-6);
}

/// An open box room of side `side` seen from inside: walls, floor and ceiling, one metre-scale post in the middle.
Model room_model(double side, const glm::dvec3& world) {
  Model model = *generate_model("house", 1'000, 1);
  model.meshes.resize(1);
  model.instances.assign(1, {0, glm::dmat4(1)});
  Mesh& mesh = model.meshes[0];
  mesh = Mesh{};
  const float s = static_cast<float>(side), h = 0.5f * s;
  const auto quad = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& p : {a, b, c, d}) mesh.positions.push_back(p);
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
  };
  quad({0, 0, s}, {s, 0, s}, {s, 0, 0}, {0, 0, 0});
  quad({0, h, 0}, {s, h, 0}, {s, h, s}, {0, h, s});
  quad({0, 0, 0}, {s, 0, 0}, {s, h, 0}, {0, h, 0});
  quad({s, 0, s}, {0, 0, s}, {0, h, s}, {s, h, s});
  quad({0, 0, s}, {0, 0, 0}, {0, h, 0}, {0, h, s});
  quad({s, 0, 0}, {s, 0, s}, {s, h, s}, {s, h, 0});
  model.instances[0].world_from_mesh[3] = glm::dvec4(world, 1);
  model.materials.assign(1, {});
  return model;
}

TEST(WalkPath, TinyScenesAreWalkedByTinyVisitors) {
  const Result<std::shared_ptr<const Scene>> scene = Scene::build(room_model(1e-3, {0, 0, 0}));
  ASSERT_TRUE(scene.has_value());
  TraceOptions options;
  options.seconds = 5;
  const Result<Trace> trace = generate_trace(**scene, options);
  ASSERT_TRUE(trace.has_value()) << trace.error().message;
  const TraceSummary summary = summarise(*trace);
  EXPECT_NEAR(summary.speed_p95_m_s, 1.4e-4, 0.05e-4);
  for (const TraceFrame& frame : trace->frames) EXPECT_GE(nearest_hit(**scene, frame.pose.position - (*scene)->origin(), 1e-4), 0.25e-4);
}

TEST(WalkPath, FarFromTheOriginTheTraceIsInTheWorld) {
  const glm::dvec3 world(4.1e6, 120, -7.3e6);
  const Result<std::shared_ptr<const Scene>> scene = Scene::build(room_model(12, world));
  ASSERT_TRUE(scene.has_value());
  TraceOptions options;
  options.seconds = 5;
  const Result<Trace> trace = generate_trace(**scene, options);
  ASSERT_TRUE(trace.has_value()) << trace.error().message;
  for (const TraceFrame& frame : trace->frames) {
    const glm::dvec3 p = frame.pose.position - world;
    EXPECT_TRUE(p.x > 0.3 && p.x < 11.7 && p.z > 0.3 && p.z < 11.7) << p.x << ' ' << p.z;
    EXPECT_NEAR(p.y, 1.7, 1e-3);
  }
}

TEST(WalkPath, StandingPointsAreWhereAPersonCouldStand) {
  const auto scene = scene_of("city", 150'000);
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const Result<glm::dvec3> eye = standing_point(*scene, seed);
    ASSERT_TRUE(eye.has_value()) << eye.error().message;
    EXPECT_GE(nearest_hit(*scene, *eye, 1), 0.3);
    EXPECT_NEAR(floor_distance(*scene, *eye), 1.7, 0.01);
  }
}

TEST(WalkPath, OptionsAreChecked) {
  const auto scene = scene_of("pipes", 5'000);
  TraceOptions options;
  options.seconds = -1;
  EXPECT_EQ(generate_trace(*scene, options).error().code, ErrorCode::kInvalidArgument);
  options.seconds = 1;
  options.speed_m_s = std::nan("");
  EXPECT_EQ(generate_trace(*scene, options).error().code, ErrorCode::kInvalidArgument);
}

TEST(TraceMap, TextShowsStartPathAndEnd) {
  Trace trace;
  for (int i = 0; i <= 10; ++i) trace.frames.push_back({i * 0.1, {{i, 1.7, 0}, {1, 0, 0, 0}}});
  const std::string map = text_map(trace, nullptr, 40);
  const std::size_t start = map.find('S'), end = map.find('E');
  ASSERT_NE(start, std::string::npos);
  ASSERT_NE(end, std::string::npos);
  EXPECT_LT(start, end);  // +X to the right, on one line
  EXPECT_EQ(map.substr(start, end - start).find('\n'), std::string::npos);
  EXPECT_EQ(svg_map(trace, nullptr).find("nan"), std::string::npos);
}

TEST(TraceMap, OneFrameIsDrawnToo) {
  Trace trace;
  trace.frames.push_back({0, {{5, 1, 5}, {1, 0, 0, 0}}});
  EXPECT_NE(text_map(trace, nullptr).find('S'), std::string::npos);
  EXPECT_EQ(svg_map(trace, nullptr).find("nan"), std::string::npos);
}

}  // namespace
}  // namespace farfield

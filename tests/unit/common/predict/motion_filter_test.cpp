// SPDX-License-Identifier: Apache-2.0
#include "common/predict/motion_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace farfield {
namespace {

using Outcome = MotionFilter::Outcome;

const glm::dvec3 kVelocity{1.0, 0.0, -1.0};

// Reports a straight walk from `begin_s` to `end_s`.
void walk(MotionFilter& filter, double begin_s, double end_s, double rate_hz, const glm::dvec3& start,
          const glm::dvec3& velocity) {
  const int poses = static_cast<int>(std::lround((end_s - begin_s) * rate_hz));
  for (int i = 0; i <= poses; ++i) {
    const double t = begin_s + i / rate_hz;
    filter.update(start + velocity * (t - begin_s), t);
  }
}

TEST(MotionFilter, PredictsAStraightWalkToACentimetre) {
  for (const double rate_hz : {10.0, 30.0, 90.0}) {
    MotionFilter filter;
    walk(filter, 0, 3, rate_hz, {5, 1.7, 2}, kVelocity);
    for (const double ahead_s : {0.0, 0.25, 1.0, 4.0}) {
      const glm::dvec3 truth = glm::dvec3{5, 1.7, 2} + kVelocity * (3 + ahead_s);
      EXPECT_LT(glm::length(filter.predict(ahead_s).position - truth), 0.01) << rate_hz << " Hz, " << ahead_s << " s";
    }
  }
}

TEST(MotionFilter, LearnsTheSpeedFromUnevenTimes) {
  MotionFilter filter;
  std::mt19937 random(3);
  double t = 0;
  for (int i = 0; i < 100; ++i) {
    filter.update(kVelocity * t, t);
    t += 0.005 + 0.05 * static_cast<double>(random() % 100) / 100.0;
  }
  EXPECT_LT(glm::length(filter.velocity() - kVelocity), 0.01);
}

TEST(MotionFilter, SmoothsTheSwayOfAHead) {
  MotionFilter filter;
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    const double t = i / 60.0;
    // Two steps a second, a centimetre to either side.
    filter.update(kVelocity * t + glm::dvec3(0, 0.01 * std::sin(2 * 3.14159265 * t), 0), t);
    if (i > 60) worst = std::max(worst, glm::length(filter.predict(1.0).position - kVelocity * (t + 1)));
  }
  EXPECT_LT(worst, 0.15);
}

TEST(MotionFilter, AnyScaleOfCoordinates) {
  MotionFilter filter;
  const glm::dvec3 far{4.5e6, 200, -6.2e6};
  walk(filter, 1e6, 1e6 + 2, 60, far, kVelocity);
  EXPECT_LT(glm::length(filter.predict(1).position - (far + kVelocity * 3.0)), 0.01);
}

TEST(MotionFilter, FollowsATurnWithinHalfASecond) {
  MotionFilter filter;
  walk(filter, 0, 2, 30, {0, 0, 0}, {1.4, 0, 0});
  walk(filter, 2 + 1 / 30.0, 2.5, 30, {2.8, 0, 1.4 / 30}, {0, 0, 1.4});
  EXPECT_LT(glm::length(filter.velocity() - glm::dvec3(0, 0, 1.4)), 0.15);
}

TEST(MotionFilter, ForgetsTheOldVelocityInASharpTurn) {
  MotionFilter filter;
  walk(filter, 0, 2, 10, {0, 0, 0}, {5, 0, 0});
  EXPECT_EQ(filter.update({9.5, 0, 0}, 2.1), Outcome::kTurned);  // back at once
  filter.update({9.0, 0, 0}, 2.2);
  filter.update({8.5, 0, 0}, 2.3);
  EXPECT_LT(glm::length(filter.velocity() - glm::dvec3(-5, 0, 0)), 0.5);
}

TEST(MotionFilter, AJumpStartsOverAtRest) {
  MotionFilter filter;
  walk(filter, 0, 2, 30, {0, 0, 0}, kVelocity);
  EXPECT_EQ(filter.update({500, 0, 0}, 2.05), Outcome::kStarted);
  EXPECT_LT(glm::length(filter.predict(2).position - glm::dvec3(500, 0, 0)), 1e-9);
  EXPECT_GT(filter.velocity_sigma_m_s(), 1.0);
}

TEST(MotionFilter, APauseStartsOverAtRest) {
  MotionFilter filter;
  walk(filter, 0, 2, 30, {0, 0, 0}, kVelocity);
  EXPECT_EQ(filter.update({2, 0, -2}, 60), Outcome::kStarted);
  EXPECT_LT(glm::length(filter.velocity()), 1e-12);
}

TEST(MotionFilter, StandingStillIsPredictedToStay) {
  MotionFilter filter;
  walk(filter, 0, 1, 30, {0, 0, 0}, kVelocity);
  for (int i = 1; i <= 60; ++i) filter.update({1, 0, -1}, 1 + i / 30.0);
  EXPECT_LT(glm::length(filter.predict(4).position - glm::dvec3(1, 0, -1)), 0.01);
}

TEST(MotionFilter, IgnoresWhatCannotBeMeant) {
  MotionFilter filter;
  walk(filter, 0, 1, 30, {0, 0, 0}, kVelocity);
  const glm::dvec3 before = filter.predict(1).position;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(filter.update({nan, 0, 0}, 1.1), Outcome::kIgnored);
  EXPECT_EQ(filter.update({1, 0, 0}, nan), Outcome::kIgnored);
  EXPECT_EQ(filter.update({1, 0, 0}, std::numeric_limits<double>::infinity()), Outcome::kIgnored);
  EXPECT_EQ(filter.update({1, 0, 0}, 0.5), Outcome::kIgnored);  // out of order
  EXPECT_EQ(filter.update({1, 0, 0}, filter.time_s()), Outcome::kIgnored);
  EXPECT_LT(glm::length(filter.predict(1).position - before), 1e-12);
}

// The filter's own claim holds: errors of a random walk in velocity lie within the predicted deviation.
TEST(MotionFilter, ItsUncertaintyIsHonest) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const MotionSettings settings;
  double normalised = 0;
  const int walks = 300;
  for (int w = 0; w < walks; ++w) {
    MotionFilter filter(settings);
    const double dt = 1 / 30.0;
    double x = 0, v = 1;
    for (int i = 0; i < 60; ++i) {
      filter.update({x + settings.position_sigma_m * normal(random), 0, 0}, i * dt);
      v += std::sqrt(settings.acceleration_density * dt) * normal(random);
      x += v * dt;
    }
    const PredictedPosition ahead = filter.predict(1.0 + dt);
    for (int i = 0; i < 30; ++i) {
      v += std::sqrt(settings.acceleration_density * dt) * normal(random);
      x += v * dt;
    }
    normalised += (x - ahead.position.x) * (x - ahead.position.x) / (ahead.sigma_m * ahead.sigma_m);
  }
  EXPECT_NEAR(normalised / walks, 1.0, 0.35);  // four standard deviations of a mean of 300 squares
}

}  // namespace
}  // namespace farfield

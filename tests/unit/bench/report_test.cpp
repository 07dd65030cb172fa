// SPDX-License-Identifier: Apache-2.0
// The keys of farfield-bench/1 that programs rely on.
#include "tests/bench/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/unit/server/scene/scene_models.h"

namespace farfield::bench {
namespace {

using testing::HasSubstr;

World world() {
  World world;
  world.scene = test::build(test::model_of(test::sphere(4)));
  return world;
}

TEST(Report, MethodsHaveCertificateAndBorderFlipNullWhereThereIsNone) {
  MethodResult known;
  known.name = "known";
  known.certificate = {.void_share = 1e-5, .psnr_db = 35, .warp_px = 0.5, .holds_share = 1};
  known.border_flip = {.inside_p99 = 0.001, .crossing_p99 = 0.002, .after_crossing_p99 = 0.003};
  const nlohmann::json json = to_json(world(), {known, {.name = "unknown"}}, {});
  EXPECT_EQ(json.at("format"), "farfield-bench/1");
  const nlohmann::json& first = json.at("methods").at(0);
  EXPECT_EQ(first.at("certificate"), (nlohmann::json{{"void_share", 1e-5}, {"psnr_db", 35.0}, {"warp_px", 0.5}, {"holds_share", 1.0},
                                                          {"void_slack", nullptr}, {"psnr_slack_db", nullptr}, {"warp_slack_px", nullptr},
                                                          {"frames", nlohmann::json::array()}}));
  EXPECT_EQ(first.at("border_flip"), (nlohmann::json{{"inside_p99", 0.001}, {"crossing_p99", 0.002}, {"after_crossing_p99", 0.003}}));
  const nlohmann::json& second = json.at("methods").at(1);
  for (const char* key : {"void_share", "psnr_db", "warp_px", "holds_share"})
    EXPECT_TRUE(second.at("certificate").at(key).is_null()) << key;
  for (const char* key : {"inside_p99", "crossing_p99", "after_crossing_p99"}) EXPECT_TRUE(second.at("border_flip").at(key).is_null()) << key;
}

TEST(Report, CurvesHaveTheirPoints) {
  EXPECT_TRUE(to_json(world(), {}, {}).at("curves").empty());
  const Curve curve{"rays", "samples", {{.value = 4, .frame_ms = 100, .flip = 0.01, .psnr_db = 40}}};
  const nlohmann::json json = to_json(world(), {}, {curve}).at("curves");
  const nlohmann::json point{{"value", 4.0}, {"frame_ms", 100.0}, {"mbit_s", nullptr}, {"flip", 0.01}, {"psnr_db", 40.0}};
  EXPECT_EQ(json, (nlohmann::json::array({{{"name", "rays"}, {"knob", "samples"}, {"points", nlohmann::json::array({point})}}})));
}

TEST(Report, SaysWhereFarfieldIsNotBelowAndLeft) {
  MethodResult farfield, rays;
  farfield.name = "farfield-cpu", farfield.frame_p50 = 10, farfield.error.flip_mean = 0.02, farfield.mbit_s_warm = 2;
  rays.name = "rays", rays.frame_p50 = 100, rays.error.flip_mean = 0.01;
  Curve slow{"geometry", "samples", {{.value = 1, .frame_ms = 300, .flip = 0.03}}};
  std::ostringstream out;
  print_dominance({farfield, rays}, {slow}, out);
  EXPECT_THAT(out.str(), HasSubstr("farfield-cpu does not lie below and left of rays (100 ms, FLIP 0.0100)"));
  EXPECT_THAT(out.str(), HasSubstr("farfield-cpu lies below and left of geometry:samples"));
  EXPECT_EQ(out.str().find("bytes per second"), std::string::npos);  // neither streams
}

}  // namespace
}  // namespace farfield::bench

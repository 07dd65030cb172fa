// SPDX-License-Identifier: Apache-2.0
#include "client/load/threshold.h"

#include <gtest/gtest.h>

#include <cmath>

namespace farfield::client {
namespace {

const nlohmann::json kReport = {{"cell_ready_ms", {{"p95", 249.0}, {"max", 900.0}}}, {"first_picture_ms", {{"p95", nullptr}}}, {"away_ms", {{"max", nullptr}}},
                                {"late_share", 0.02}, {"mbit_s_per_client", 3.5}, {"errors", {{"io", 2}, {"unavailable", 1}}}};

bool is_met(const char* text) { return judge(parse_threshold(text).value(), kReport).is_met; }

TEST(Threshold, UnitsAreTheReports) {
  EXPECT_DOUBLE_EQ(parse_threshold("cell_ready_p95<250ms")->below, 250);
  EXPECT_DOUBLE_EQ(parse_threshold("cell_ready_p95<0.25s")->below, 250);
  EXPECT_DOUBLE_EQ(parse_threshold("own_lag_p999<500us")->below, 0.5);
  EXPECT_DOUBLE_EQ(parse_threshold("late_share<2%")->below, 0.02);
  EXPECT_DOUBLE_EQ(parse_threshold("errors<1")->below, 1);
}

TEST(Threshold, JudgesWhatWasMeasured) {
  EXPECT_TRUE(is_met("cell_ready_p95<250ms"));
  EXPECT_FALSE(is_met("cell_ready_p95<249ms")) << "below means below";
  EXPECT_FALSE(is_met("cell_ready_max<0.5s"));
  EXPECT_TRUE(is_met("late_share<3%"));
  EXPECT_TRUE(is_met("errors<4"));
  EXPECT_FALSE(is_met("errors<3")) << "kinds add up";
}

TEST(Threshold, NothingMeasuredMeetsNothingUnlessItIsAnAbsence) {
  EXPECT_FALSE(is_met("first_picture_p95<10s"));
  EXPECT_TRUE(std::isnan(judge(parse_threshold("first_picture_p95<10s").value(), kReport).measured));
  EXPECT_TRUE(is_met("away_max<1ms"));
}

TEST(Threshold, SaysWhatIsWrong) {
  for (const char* text : {"", "cell_ready_p95", "cell_ready_p95>250ms", "cell_ready_p95<250", "cell_ready_p95<ms", "cell_ready_p94<1ms", "p95<1ms", "late_share<1ms",
                           "errors<1%", "cell_ready_p95<infms", "speed<1"}) {
    const auto threshold = parse_threshold(text);
    ASSERT_FALSE(threshold) << text;
    EXPECT_EQ(threshold.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(threshold.error().message.find("cell_ready_p95<250ms"), std::string::npos) << "an example";
  }
}

}  // namespace
}  // namespace farfield::client

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace farfield::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A method whose frame time and error are what its knob says.
std::vector<Method> methods() {
  const auto run = [](const World&, const KnobValues& knobs) -> Result<MethodResult> {
    if (knobs["effort"] > 8) return fail(ErrorCode::kUnavailable, "too much effort");
    MethodResult result;
    result.frame_p50 = 10 * knobs["effort"], result.error.flip_mean = 1 / knobs["effort"], result.error.psnr_mean = 30;
    return result;
  };
  return {{"example", "an example", {{"effort", 1, "effort", 1, 10}}, run}};
}

std::string complaint(const std::string& text) {
  const Result<Sweep> sweep = parse_sweep(text, methods());
  return sweep ? "" : sweep.error().message;
}

TEST(Sweep, IsParsed) {
  const Result<Sweep> sweep = parse_sweep("example:effort=4,1,2.5", methods());
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->method, "example");
  EXPECT_EQ(sweep->knob, "effort");
  EXPECT_THAT(sweep->values, ElementsAre(4, 1, 2.5));
}

TEST(Sweep, ErrorsAreOneLineThatSaysWhatIsWrong) {
  EXPECT_THAT(complaint("example"), HasSubstr("METHOD:KNOB=a,b,c"));
  EXPECT_THAT(complaint("example:effort"), HasSubstr("METHOD:KNOB=a,b,c"));
  EXPECT_THAT(complaint("effort=1:2"), HasSubstr("METHOD:KNOB=a,b,c"));
  EXPECT_THAT(complaint("other:effort=1"), HasSubstr("no method 'other'"));
  EXPECT_THAT(complaint("example:speed=1"), HasSubstr("no knob 'speed' (it has effort)"));
  EXPECT_THAT(complaint("example:effort=1,x"), HasSubstr("'x' is no number"));
  for (const char* text : {"example:effort=", "example:effort=1,", "example:effort=,1", "example:effort=1,,2"})
    EXPECT_THAT(complaint(text), HasSubstr("'' is no number")) << text;
  EXPECT_THAT(complaint("example:effort=11"), HasSubstr("1 to 10, not 11"));
  EXPECT_THAT(complaint("example:effort=nan"), HasSubstr("not nan"));
  for (const char* text : {"example", "other:effort=1", "example:effort=1,x"}) EXPECT_EQ(complaint(text).find('\n'), std::string::npos);
}

TEST(Sweep, RunsOncePerValueInOrder) {
  const Result<Curve> curve = run_sweep({}, methods(), {"example", "effort", {4, 2}});
  ASSERT_TRUE(curve);
  ASSERT_EQ(curve->points.size(), 2u);
  EXPECT_DOUBLE_EQ(curve->points[0].value, 4);
  EXPECT_DOUBLE_EQ(curve->points[0].frame_ms, 40);
  EXPECT_DOUBLE_EQ(curve->points[1].flip, 0.5);
  EXPECT_TRUE(std::isnan(curve->points[1].mbit_s));
}

TEST(Sweep, SaysWhichRunFailed) {
  const Result<Curve> curve = run_sweep({}, methods(), {"example", "effort", {1, 9}});
  ASSERT_FALSE(curve);
  EXPECT_THAT(curve.error().message, HasSubstr("example:effort=9: too much effort"));
}

}  // namespace
}  // namespace farfield::bench

// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/bench/methods.h"

namespace farfield::bench {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

Method example() {
  return {"example",
          "shows nothing",
          {{"quality", 76, "JPEG quality", 1, 100, true},
           {"error_px", 1, "pixels"},
           {.name = "samples", .default_value = 1, .choices = {1, 4}}},
          nullptr};
}

TEST(Method, AllHaveNamesOfTheirOwnASummaryAndAWayToRun) {
  std::set<std::string> names;
  for (const Method& method : all_methods({})) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_FALSE(method.summary.empty()) << method.name;
    EXPECT_TRUE(method.run) << method.name;
  }
  EXPECT_TRUE(names.contains("rays") && names.contains("geometry-culled") && names.contains("farfield-gl"));
}

TEST(Method, DefaultsAreAllowed) {
  BenchOptions options;
  for (const Method& method : all_methods(options))
    for (const Knob& knob : method.knobs) EXPECT_THAT(objection_to(method, {knob.name, knob.default_value}), IsEmpty());
}

TEST(Method, FarfieldsKnobsBeginWhereTheFlagsPutThem) {
  BenchOptions options;
  options.settings.colour_quality = 33, options.client_samples = 4;
  const std::vector<Method> methods = all_methods(options);
  const KnobValues values = values_of(*find_method(methods, "farfield-cpu"), {});
  EXPECT_EQ(values.whole("quality"), 33);
  EXPECT_EQ(values.whole("client-samples"), 4);
}

TEST(Method, SettingsReplaceDefaults) {
  const KnobSetting settings[] = {{"error_px", 2.5}};
  const KnobValues values = values_of(example(), settings);
  EXPECT_DOUBLE_EQ(values["error_px"], 2.5);
  EXPECT_DOUBLE_EQ(values["quality"], 76);
}

TEST(Method, ValuesOutOfRangeAreRefusedInOneLine) {
  const Method method = example();
  EXPECT_THAT(objection_to(method, {"quality", 101}), HasSubstr("a whole number, 1 to 100, not 101"));
  EXPECT_THAT(objection_to(method, {"quality", 50.5}), HasSubstr("whole"));
  EXPECT_THAT(objection_to(method, {"error_px", -1}), HasSubstr("0 or more"));
  EXPECT_THAT(objection_to(method, {"samples", 2}), HasSubstr("1|4"));
  EXPECT_THAT(objection_to(method, {"samples", std::nan("")}), Not(IsEmpty()));
  EXPECT_THAT(objection_to(method, {"speed", 2}), HasSubstr("quality, error_px, samples"));
  EXPECT_THAT(objection_to(method, {"samples", 4}), IsEmpty());
}

TEST(Method, TheDescriptionNamesEveryKnob) {
  const std::vector<Method> methods{example()};
  const std::string text = describe(methods);
  for (const char* part : {"example", "shows nothing", "quality", "JPEG quality (76; 1 to 100)", "(1; 1|4)"})
    EXPECT_THAT(text, HasSubstr(part));
}

}  // namespace
}  // namespace farfield::bench

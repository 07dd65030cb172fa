// SPDX-License-Identifier: Apache-2.0
// Every stress holds its bounds, with the effort continuous integration can afford; and the table tells when one does not.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/stability/stability_program.h"

namespace farfield::stability {
namespace {

class StressTest : public testing::TestWithParam<Stress> {};

TEST_P(StressTest, Holds) {
  const Rows rows = GetParam().run(Effort{});
  ASSERT_FALSE(rows.empty());
  for (const StressRow& row : rows)
    EXPECT_TRUE(row.holds()) << row.input << " against " << row.reference << ": " << row.worst << " " << row.unit << ", at most "
                             << row.bound << " (" << row.cases << " cases)";
}

std::string test_name(const testing::TestParamInfo<Stress>& info) {
  std::string name = info.param.name;
  std::erase(name, '-');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Stability, StressTest, testing::ValuesIn(all_stresses()), test_name);

TEST(StressRow, HoldsOnlyWhatWasComparedAndIsWithinItsBound) {
  EXPECT_TRUE((StressRow{"", "", "m", 1.0, 1.0, 1}).holds());
  EXPECT_FALSE((StressRow{"", "", "m", 1.1, 1.0, 1}).holds());
  EXPECT_FALSE((StressRow{"", "", "m", 0.0, 1.0, 0}).holds()) << "nothing was compared";
  WorstError worst;
  worst.add(0.5), worst.add(-2.0), worst.add(1.0);
  EXPECT_EQ(worst.row("", "", "", 3).worst, 2.0);
  worst.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(worst.row("", "", "", 1e300).holds());
  EXPECT_EQ(worst.row("", "", "", 0).cases, 4u);
}

TEST(StabilityReport, SaysWhichBoundIsBroken) {
  const std::vector<StressResult> fine{{"a", "first", {{"x", "exact", "m", 0.5, 1, 7}}}};
  std::vector<StressResult> broken = fine;
  broken.push_back({"b", "second", {{"y", "exact", "m", INFINITY, 1, 3}}});
  EXPECT_TRUE(all_hold(fine));
  EXPECT_FALSE(all_hold(broken));
  EXPECT_FALSE(all_hold({})) << "no row, no promise";
  const nlohmann::json json = to_json(broken, {});
  EXPECT_EQ(json["format"], "farfield-stability/1");
  EXPECT_EQ(json["holds"], false);
  ASSERT_EQ(json["rows"].size(), 2u);
  EXPECT_EQ(json["rows"][0]["worst"], 0.5);
  EXPECT_TRUE(json["rows"][1]["worst"].is_null());
  EXPECT_EQ(json["rows"][1]["holds"], false);
  std::ostringstream table;
  print_table(broken, table);
  EXPECT_NE(table.str().find("| y | exact | inf | 1 | m | 3 | NO |"), std::string::npos) << table.str();
}

TEST(StabilityProgram, RefusesWhatItDoesNotKnow) {
  const char* unknown[] = {"farfield-stability", "--only", "leaks,lekas"};
  EXPECT_EQ(run_program(3, unknown), 2);
  const char* flag[] = {"farfield-stability", "--ful"};
  EXPECT_EQ(run_program(2, flag), 2);
  const char* file[] = {"farfield-stability", "--only", "float-modes", "--json", "/no/such/folder/out.json"};
  EXPECT_EQ(run_program(5, file), 1);
}

}  // namespace
}  // namespace farfield::stability

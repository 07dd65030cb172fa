// SPDX-License-Identifier: Apache-2.0
#include "client/load/load_report.h"

#include <gtest/gtest.h>

#include <sstream>

#include "client/load/load_options.h"
#include "client/load/server_metrics.h"

namespace farfield::client {
namespace {

TEST(LoadReport, HasTheDocumentedKeysWhateverWasMeasured) {
  const nlohmann::json report = load_report({}, {}, {});
  EXPECT_EQ(report.at("format"), "farfield-load/1");
  for (const char* key : {"clients", "seconds", "link", "late_share", "bytes", "mbit_s_per_client", "cells", "errors", "own_cpu_s"}) EXPECT_TRUE(report.contains(key)) << key;
  for (const char* key : {"connect_ms", "first_picture_ms", "cell_ready_ms", "away_ms", "own_lag_ms"})
    for (const char* quantile : {"p50", "p90", "p95", "p99", "p999", "max"}) EXPECT_TRUE(report.at(key).at(quantile).is_null()) << key << quantile;
  std::ostringstream text;
  print_load_report(report, text);
  EXPECT_NE(text.str().find("cell_ready_ms"), std::string::npos);
}

TEST(LoadReport, AddsUpViewers) {
  WalkerFigures one, two;
  one.cell_ready.add(0.1), two.cell_ready.add(0.3), two.away.add(2);
  one.errors["io"] = 1, two.errors["io"] = 2, two.never_connected = 1;
  one.statistics.bytes_in = 1000, two.statistics.bytes_in = 3000, one.statistics.frames = 90, one.statistics.late_frames = 9;
  one.seconds = 2, two.seconds = 2;
  LoadOutcome outcome;
  outcome.figures.add(one), outcome.figures.add(two);
  outcome.arrived = 2;
  LoadOptions options;
  options.link = parse_link_model("rate=20mbit,delay=50ms").value();
  const nlohmann::json report = load_report(options, outcome, 7);
  EXPECT_DOUBLE_EQ(report["cell_ready_ms"]["max"], 300);
  EXPECT_EQ(report["cell_ready_ms"]["count"], 2);
  EXPECT_DOUBLE_EQ(report["away_ms"]["max"], 2000);
  EXPECT_EQ(report["errors"]["io"], 3);
  EXPECT_EQ(report["errors"]["never_connected"], 1);
  EXPECT_DOUBLE_EQ(report["late_share"], 0.1);
  EXPECT_DOUBLE_EQ(report["mbit_s_per_client"], 8e-6 * 4000 / 4);
  EXPECT_EQ(report["cells"]["made"], 7);
  EXPECT_DOUBLE_EQ(report["link"]["delay_ms"], 50);
}

TEST(MetricOf, SumsOverLabelsAndTakesNoOtherName) {
  const std::string page =
      "# HELP farfield_leaf_plans_total Leaf plans.\n# TYPE farfield_leaf_plans_total counter\n"
      "farfield_leaf_plans_total{scene=\"a b\"} 3\nfarfield_leaf_plans_total{scene=\"c\"} 4\nfarfield_leaf_plans_total_other 100\nfarfield_up 1\n";
  EXPECT_DOUBLE_EQ(metric_of(page, "farfield_leaf_plans_total").value(), 7);
  EXPECT_DOUBLE_EQ(metric_of(page, "farfield_up").value(), 1);
  EXPECT_FALSE(metric_of(page, "farfield"));
  EXPECT_FALSE(metric_of("", "farfield_up"));
}

TEST(ParseArrival, TakesRates) {
  EXPECT_DOUBLE_EQ(parse_arrival("20/s").value(), 20);
  EXPECT_DOUBLE_EQ(parse_arrival("90/min").value(), 1.5);
  EXPECT_DOUBLE_EQ(parse_arrival("0.5").value(), 0.5);
  for (const char* text : {"", "0", "-1/s", "20/h", "fast", "1e9/s"}) EXPECT_FALSE(parse_arrival(text)) << text;
}

}  // namespace
}  // namespace farfield::client

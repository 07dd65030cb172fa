// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/promises.h"

#include <gtest/gtest.h>

#include "tests/bench/calibration.h"

namespace farfield::bench {
namespace {

KeptPromise frame(double void_share, double psnr_db, double warp_px) {
  return {{.void_share = 1e-3, .psnr_db = 30, .warp_px = 1, .expected_void_share = 1e-4, .expected_psnr_db = 32}, void_share, psnr_db, warp_px};
}

TEST(Promises, AnyFigureThatIsWorseThanPromisedBreaksIt) {
  EXPECT_TRUE(frame(1e-4, 31, 0.5).holds());
  EXPECT_FALSE(frame(2e-3, 31, 0.5).holds());
  EXPECT_FALSE(frame(1e-4, 29, 0.5).holds());
  EXPECT_FALSE(frame(1e-4, 31, 1.5).holds());
  EXPECT_TRUE(frame(1e-4, kNone, kNone).holds()) << "what was not measured breaks nothing";
}

TEST(Promises, FiguresAreMeansAndTheShareThatHolds) {
  const CertificateFigures figures = certificate_figures({frame(1e-4, 31, kNone), frame(1e-4, 27, 0.5), {}});
  EXPECT_DOUBLE_EQ(figures.psnr_db, 30);
  EXPECT_DOUBLE_EQ(figures.holds_share, 0.5) << "a frame without a promise is none of them";
  EXPECT_NEAR(figures.psnr_slack_db, -1, 1e-12);
  EXPECT_NEAR(figures.void_slack, 9e-4, 1e-12);
  EXPECT_NEAR(figures.warp_slack_px, 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(certificate_figures({}).holds_share));
}

TEST(Promises, SurviveTheirWayThroughJson) {
  const KeptPromise sent = frame(1e-4, kNone, 0.25), read = kept_promise_from(to_json(sent));
  EXPECT_DOUBLE_EQ(read.promise.void_share, sent.promise.void_share);
  EXPECT_DOUBLE_EQ(read.warp_px, 0.25);
  EXPECT_TRUE(std::isnan(read.psnr_db));
  EXPECT_DOUBLE_EQ(promise_from(to_json(sent.promise)).expected_psnr_db, 32);
}

TEST(Calibration, TableAndPlotShowEveryRun) {
  const std::vector<CalibrationRun> runs{{"one", {frame(1e-4, 31, 0.5)}}, {"two", {frame(1e-2, 28, 0.5)}}};
  const std::string table = calibration_table(runs), plot = calibration_plot(runs);
  for (const char* name : {"one", "two"}) {
    EXPECT_NE(table.find(name), std::string::npos);
    EXPECT_NE(plot.find(name), std::string::npos);
  }
  EXPECT_NE(table.find("50.0"), std::string::npos) << "of both runs half the frames keep their promise\n" << table;
}

}  // namespace
}  // namespace farfield::bench

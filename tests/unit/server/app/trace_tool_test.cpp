// SPDX-License-Identifier: Apache-2.0
#include "server/app/trace_tool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "common/image/png.h"
#include "common/trace/trace_file.h"
#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

Trace straight_walk() {
  Trace trace;
  for (int i = 0; i <= 20; ++i) trace.frames.push_back({0.1 * i, {{0.5 * i, 1.7, 0}, glm::dquat(1, 0, 0, 0)}});
  return trace;
}

TEST(TraceTool, ShowsATraceAsPicture) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_trace(folder.path() / "walk.txt", straight_walk()));
  TraceShowOptions options;
  options.file = folder.path() / "walk.txt";
  options.svg = folder.path() / "walk.svg";
  options.png = folder.path() / "walk.png";
  std::ostringstream out;
  const Status shown = run_trace_show(options, out);
  ASSERT_TRUE(shown) << shown.error().message;
  EXPECT_TRUE(std::filesystem::exists(options.svg));
  const auto image = read_png(options.png.string(), 3);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 900);
  // The path crosses the middle of the drawing from left to right, S green, the rest red.
  const auto is_red = [&](int x) {
    for (int y = 0; y < image->height; ++y) {
      const std::uint8_t* texel = image->at(x, y);
      if (texel[0] > 150 && texel[1] < 100 && texel[2] < 100) return true;
    }
    return false;
  };
  for (const int x : {215, 465, 715}) EXPECT_TRUE(is_red(x)) << x;
  EXPECT_FALSE(is_red(5));
  EXPECT_FALSE(is_red(895));
}

TEST(TraceTool, SeveralWalksComeFromSeedsOfTheirOwn) {
  const TemporaryFolder folder;
  TraceGenerateOptions options;
  options.scene = "pipes:20000:1";
  options.trace.seconds = 4;
  options.trace.seed = 5;
  options.count = 3;
  options.is_json = true;
  options.output = folder.path() / "walks";
  std::ostringstream out, talk;
  const Status made = run_trace_generate(options, out, talk);
  ASSERT_TRUE(made) << made.error().message;
  std::vector<Trace> walks;
  for (const auto& entry : std::filesystem::directory_iterator(options.output)) walks.push_back(read_trace(entry.path()).value());
  ASSERT_EQ(walks.size(), 3u);
  EXPECT_GT(glm::distance(walks[0].frames.back().pose.position, walks[1].frames.back().pose.position), 0.01);
  const std::string report = out.str();
  EXPECT_EQ(std::count(report.begin(), report.end(), '\n'), 3) << "an object a line";
  // One alone of the same seed is the same.
  options.count = 1;
  options.output = folder.path() / "one.trace";
  ASSERT_TRUE(run_trace_generate(options, out, talk));
  const Trace one = read_trace(options.output).value(), first = read_trace(folder.path() / "walks" / "5.trace").value();
  EXPECT_LT(glm::distance(one.frames.back().pose.position, first.frames.back().pose.position), 1e-9);
}

TEST(TraceTool, OutputsThatCannotBeWrittenLeaveNothing) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_trace(folder.path() / "walk.txt", straight_walk()));
  for (auto member : {&TraceShowOptions::svg, &TraceShowOptions::png}) {
    TraceShowOptions options;
    options.file = folder.path() / "walk.txt";
    for (const char* bad : {"no/folder/map", "."}) {
      options.*member = folder.path() / bad;
      std::ostringstream out;
      const Status shown = run_trace_show(options, out);
      ASSERT_FALSE(shown) << bad;
      EXPECT_EQ(shown.error().code, ErrorCode::kIo) << bad;
    }
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(TraceTool, AMissingFolderIsSaidBeforeTheSceneIsLoaded) {
  TraceGenerateOptions options;
  options.scene = "no-such-scene.glb";
  options.output = "no/such/folder/walk.txt";
  std::ostringstream out, talk;
  const Status made = run_trace_generate(options, out, talk);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, testing::HasSubstr("no/such/folder"));
}

}  // namespace
}  // namespace farfield

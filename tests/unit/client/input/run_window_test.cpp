// SPDX-License-Identifier: Apache-2.0
// The window, on a display server of its own (Xvfb) where none is there.
#include "client/input/run_window.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/trace/trace_file.h"

namespace farfield::client {
namespace {

/// Starts Xvfb unless a display server is running already.
class DisplayServer : public testing::Environment {
 public:
  void SetUp() override {
    if (std::getenv("DISPLAY")) return;
    int channel[2] = {};
    ASSERT_EQ(pipe(channel), 0);
    process_ = fork();
    if (process_ == 0) {
      close(channel[0]);
      const std::string descriptor = std::to_string(channel[1]);
      execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1280x800x24", "-nolisten", "tcp",
             static_cast<char*>(nullptr));
      _exit(127);
    }
    close(channel[1]);
    // The server writes its number and a line end once it listens; closing earlier would kill it.
    std::string number;
    for (char c = 0; c != '\n' && read(channel[0], &c, 1) == 1;) number += c;
    close(channel[0]);
    ASSERT_FALSE(number.empty()) << "Xvfb did not start; install the package xvfb";
    setenv("DISPLAY", (":" + std::to_string(std::stoi(number))).c_str(), 1);
  }
  void TearDown() override {
    if (process_ <= 0) return;
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }

 private:
  pid_t process_ = -1;
};
[[maybe_unused]] const auto* const kDisplayServer = testing::AddGlobalTestEnvironment(new DisplayServer);

struct CountingSource {
  int views = 0, poses = 0, counted = 0;
  Pose last;
  WindowSource source() {
    return {[this]() -> std::shared_ptr<const LeafView> {
              ++views;
              return nullptr;
            },
            [this](const Pose& pose, double) { ++poses, last = pose; },
            [this](const LeafView*, const glm::dvec3&) { return ++counted % 2 == 0; },
            {}};
  }
};

WindowOptions small_window() {
  WindowOptions options;
  options.display = {160, 120, 1.0};
  options.wait_for_vsync = false;
  options.most_frames = 5;
  return options;
}

class RunWindow : public testing::TestWithParam<Renderer> {};

TEST_P(RunWindow, DrawsAndCountsFrames) {
  CountingSource counting;
  WindowOptions options = small_window();
  options.renderer = GetParam();
  options.start.position = {3, 4, 5};
  const auto summary = run_window(counting.source(), options);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->frames, 5u);
  EXPECT_EQ(counting.views, 5);
  EXPECT_EQ(summary->late_frames, 2u);
  EXPECT_EQ(counting.last.position, glm::dvec3(3, 4, 5));
  EXPECT_GT(summary->median_frame_ms, 0);
  EXPECT_GE(summary->p99_frame_ms, summary->median_frame_ms);
}
INSTANTIATE_TEST_SUITE_P(Both, RunWindow, testing::Values(Renderer::kCpu, Renderer::kGl),
                         [](const auto& info) { return info.param == Renderer::kCpu ? "Cpu" : "Gl"; });

TEST(RunWindowTrace, ReplaysInTheSceneFrameAndEnds) {
  CountingSource counting;
  WindowOptions options = small_window();
  options.most_frames = 0;
  options.origin = {1e6, 0, 0};
  Trace trace;
  trace.frames = {{10.0, {{1e6, 1, 0}, {1, 0, 0, 0}}}, {10.2, {{1e6 + 8, 1, 0}, {1, 0, 0, 0}}}};
  options.replay = trace;
  const auto summary = run_window(counting.source(), options);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_GT(summary->frames, 1u);
  EXPECT_GT(counting.last.position.x, 1.0);
  EXPECT_LE(counting.last.position.x, 8.0);
  EXPECT_LT(summary->seconds, 10.0);
}

TEST(RunWindowTrace, RecordsInTheWorldFrame) {
  const auto path = std::filesystem::temp_directory_path() / ("farfield_window_" + std::to_string(getpid()) + ".trace");
  CountingSource counting;
  WindowOptions options = small_window();
  options.origin = {1e6, 0, -2e6};
  options.start.position = {0.5, 1.5, 2.5};
  options.records_from_start = true;
  options.record_path = path;
  const auto summary = run_window(counting.source(), options);
  ASSERT_TRUE(summary) << summary.error().message;
  ASSERT_EQ(summary->recorded.size(), 1u);
  const auto trace = read_trace(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(trace) << trace.error().message;
  ASSERT_EQ(trace->frames.size(), 5u);
  EXPECT_EQ(trace->frames[0].time_s, 0);
  EXPECT_EQ(trace->frames[4].pose.position, glm::dvec3(1e6 + 0.5, 1.5, -2e6 + 2.5));
}

TEST(RunWindowTrace, AnUnwritableTraceIsOneClearLine) {
  CountingSource counting;
  WindowOptions options = small_window();
  options.records_from_start = true;
  options.record_path = "/no/such/folder/walk.trace";
  const auto summary = run_window(counting.source(), options);
  ASSERT_FALSE(summary);
  EXPECT_NE(summary.error().message.find("/no/such/folder/walk.trace"), std::string::npos);
}

TEST(RunWindowErrors, NoDisplayServerIsOneClearLine) {
  const std::string display = std::getenv("DISPLAY");
  setenv("DISPLAY", ":54321", 1);
  CountingSource counting;
  const auto summary = run_window(counting.source(), small_window());
  setenv("DISPLAY", display.c_str(), 1);
  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(summary.error().message.find('\n'), std::string::npos);
  EXPECT_NE(summary.error().message.find("DISPLAY"), std::string::npos);
}

}  // namespace
}  // namespace farfield::client

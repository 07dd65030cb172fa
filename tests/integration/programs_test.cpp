// SPDX-License-Identifier: Apache-2.0
// The programs as their users run them: a walk over a real socket, a server that is told to stop, one that is killed.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "common/image/png.h"
#include "tests/integration/child_program.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

constexpr const char* kScene = "plant=pipes:20000:1";

class ProgramsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "farfield-programs-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// HOST:PORT that the server says it listens at.
  static std::string wait_listening(ChildProgram& server) {
    const auto line = server.wait_for_line("listening at ", 60s);
    EXPECT_TRUE(line) << server.error_out();
    return line ? line->substr(std::string("listening at ").size()) : "";
  }
  /// A walk through the plant, made by the program that makes them.
  std::string make_walk(int seconds) const {
    ChildProgram trace("farfield-trace", {"generate", "pipes:20000:1", "--seconds", std::to_string(seconds), "-o", path("walk.trace")});
    EXPECT_EQ(trace.wait(60s), 0) << trace.error_out();
    return path("walk.trace");
  }

  std::filesystem::path folder_;
};

/// How many colours an image shows; a blank one shows one.
std::size_t colour_count(const Image8& image) {
  std::set<std::uint32_t> colours;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* pixel = image.at(x, y);
      colours.insert(pixel[0] | pixel[1] << 8 | pixel[2] << 16);
    }
  }
  return colours.size();
}

TEST_F(ProgramsTest, AHeadlessWalkWritesPicturesThatShowTheScene) {
  ChildProgram server("farfield-server", {"--scene", kScene, "--listen", "127.0.0.1:0"});
  const std::string endpoint = wait_listening(server);
  ChildProgram client("farfield-client", {"--connect", endpoint, "--headless", "--lockstep", "--trace", make_walk(1), "--frames", "3",
                                          "--size", "320x180", "--frames-dir", path("frames"), "--json", "--quiet"});
  ASSERT_EQ(client.wait(90s), 0) << client.error_out();
  const auto report = nlohmann::json::parse(client.out(), nullptr, false);
  ASSERT_FALSE(report.is_discarded()) << client.out();
  EXPECT_EQ(report["frames"], 3);
  EXPECT_EQ(report["late_frames"], 0);
  EXPECT_EQ(report["payloads"]["bad"], 0);
  EXPECT_EQ(client.error_out(), "");
  for (const char* name : {"frame_000000.png", "frame_000001.png", "frame_000002.png"}) {
    const auto image = read_png(path("frames") + "/" + name);
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->width, 320);
    EXPECT_EQ(image->height, 180);
    EXPECT_GT(colour_count(*image), 50u) << name;
  }
}

TEST_F(ProgramsTest, AServerToldToStopEndsInTimeAlthoughAViewerIsThere) {
  ChildProgram server("farfield-server", {"--scene", kScene, "--listen", "127.0.0.1:0"});
  const std::string endpoint = wait_listening(server);
  ChildProgram client("farfield-client", {"--connect", endpoint, "--headless", "--trace", make_walk(60), "--size", "64x36", "--fps", "10"});
  ASSERT_TRUE(client.wait_for_line("triangles", 30s, true)) << client.error_out();
  server.send(SIGTERM);
  EXPECT_EQ(server.wait(25s), 0) << server.error_out();
  client.send(SIGINT);
  EXPECT_EQ(client.wait(10s), 130) << client.error_out();
}

TEST_F(ProgramsTest, AnIdleServerEndsAtOnceWhenInterrupted) {
  ChildProgram server("farfield-server", {"--scene", kScene, "--listen", "127.0.0.1:0"});
  wait_listening(server);
  server.send(SIGINT);
  EXPECT_EQ(server.wait(10s), 130) << server.error_out();
}

TEST_F(ProgramsTest, AViewerOutlivesAKilledServerAndGoesOnWithTheNextOne) {
  auto server = std::make_unique<ChildProgram>("farfield-server", std::vector<std::string>{"--scene", kScene, "--listen", "127.0.0.1:0"});
  const std::string endpoint = wait_listening(*server);
  ChildProgram client("farfield-client", {"--connect", endpoint, "--headless", "--trace", make_walk(8), "--size", "64x36", "--fps", "20", "--json"});
  ASSERT_TRUE(client.wait_for_line("triangles", 30s, true)) << client.error_out();
  ASSERT_FALSE(client.wait(1s)) << client.error_out();
  server->send(SIGKILL);
  ASSERT_EQ(server->wait(10s), 128 + SIGKILL);
  server = std::make_unique<ChildProgram>("farfield-server", std::vector<std::string>{"--scene", kScene, "--listen", endpoint});
  EXPECT_EQ(wait_listening(*server), endpoint);
  ASSERT_EQ(client.wait(60s), 0) << client.error_out();
  const auto report = nlohmann::json::parse(client.out(), nullptr, false);
  ASSERT_FALSE(report.is_discarded()) << client.out();
  EXPECT_GE(report["reconnects"], 1);
  EXPECT_GT(report["frames"], 40);
}

}  // namespace
}  // namespace farfield

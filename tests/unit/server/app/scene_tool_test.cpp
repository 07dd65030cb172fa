// SPDX-License-Identifier: Apache-2.0
#include "server/app/scene_tool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

namespace farfield {
namespace {

int run(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "farfield-scene");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_scene_tool(static_cast<int>(arguments.size()), arguments.data());
  testing::internal::GetCapturedStdout();
  testing::internal::GetCapturedStderr();
  return code;
}

TEST(SceneTool, ExitCodesTellUsageFromFailure) {
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_EQ(run({"info", "--help"}), 0);
  EXPECT_EQ(run({"--version"}), 0);
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(run({"info"}), 2);
  EXPECT_EQ(run({"frobnicate"}), 2);
  EXPECT_EQ(run({"info", "x.obj", "--up", "w"}), 2);
  EXPECT_EQ(run({"info", "x.obj", "--units", "0"}), 2);
  EXPECT_EQ(run({"info", "x.obj", "--shift", "1,2"}), 2);
  EXPECT_EQ(run({"generate", "pipes:2000:1"}), 2);
  EXPECT_EQ(run({"generate", "pipes:2000:1", "-o", "x.obj"}), 2);
  EXPECT_EQ(run({"info", "no-such-file.obj"}), 1);
}

TEST(SceneTool, InfoReportsAGeneratedScene) {
  std::ostringstream out;
  ASSERT_TRUE(run_scene_info({.scene = "pipes:2000:1", .is_json = true}, out));
  EXPECT_NEAR(nlohmann::json::parse(out.str())["drawn_triangles"].get<double>(), 2000, 40);
}

TEST(SceneTool, GenerateWritesAFile) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "farfield-scene-tool-test.glb";
  std::ostringstream out;
  const Status status = run_scene_generate({.scene = "pipes:2000:1", .output = path}, out);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_THAT(out.str(), testing::HasSubstr("triangles"));
  EXPECT_GT(std::filesystem::file_size(path), 1000u);
  std::filesystem::remove(path);
}

TEST(SceneTool, GenerateNeedsASceneToGenerate) {
  std::ostringstream out;
  EXPECT_EQ(run_scene_generate({.scene = "clinic.glb", .output = "x.glb"}, out).error().code,
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace farfield

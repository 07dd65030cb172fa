// SPDX-License-Identifier: Apache-2.0
// The command line of farfield-server, as far as it can be judged without serving.
#include <gtest/gtest.h>

#include <algorithm>
#include <asio/io_context.hpp>
#include <sstream>

#include "common/net/connect.h"
#include "server/app/build_service.h"
#include "server/app/load_arguments.h"
#include "server/app/quality_arguments.h"
#include "server/app/server_program.h"

namespace farfield {
namespace {

int run(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "farfield-server");
  return run_server_program(static_cast<int>(arguments.size()), arguments.data());
}

TEST(SceneArgument, NamesAreTakenOrFound) {
  for (const auto& [text, name, scene] : std::vector<std::tuple<const char*, const char*, const char*>>{
           {"models/clinic.glb", "clinic", "models/clinic.glb"},
           {"pipes:1000:1", "pipes:1000:1", "pipes:1000:1"},
           {"plant=pipes:1000:1", "plant", "pipes:1000:1"},
           {"a=models/b.glb", "a", "models/b.glb"},
           {"models/x=y.glb", "x=y", "models/x=y.glb"}}) {
    const auto argument = parse_scene_argument(text);
    ASSERT_TRUE(argument) << text;
    EXPECT_EQ(argument->name, name);
    EXPECT_EQ(argument->scene, scene);
  }
  EXPECT_FALSE(parse_scene_argument("=x"));
  EXPECT_FALSE(parse_scene_argument("x="));
}

TEST(ServerProgram, WrongUsageIsTwo) {
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--listen", "host:port"}), 2);
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--memory", "lots"}), 2);
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--redis", "unix:"}), 2);
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--redis-expiry", "never"}), 2);
  EXPECT_EQ(run({"--scene", "a=pipes:1000:1", "--scene", "a=pipes:2000:1"}), 2);
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--up", "w"}), 2);
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_EQ(run({"--version"}), 0);
}

/// Parses with the options that programs share. Returns: whether they were understood.
bool parse_shared(std::vector<const char*> arguments, ImpostorSettings& settings, LoadOptions& load) {
  CLI::App app{"", "test"};
  LoadArguments load_arguments;
  load_arguments.add_to(app);
  add_quality_options(app, settings);
  arguments.insert(arguments.begin(), "test");
  std::ostringstream out, talk;
  if (parse_command_line(app, static_cast<int>(arguments.size()), arguments.data(), out, talk)) return false;
  load = load_arguments.options();
  return true;
}

TEST(SharedOptions, ReachTheSettings) {
  ImpostorSettings settings;
  LoadOptions load;
  ASSERT_TRUE(parse_shared({"--tau", "0.25", "--face-tiles", "12", "--quality", "70", "--delta-views", "0", "--void-target", "0.001", "--one-slope",
                            "--cell-bytes", "300000", "--target-psnr", "37.5", "--certified-void", "0.01", "--certified-psnr", "0",
                            "--near-triangles", "5000", "--finest-side", "2", "--units", "0.001", "--up", "z", "--shift", "-84900,0,4.5",
                            "--memory-gb", "2"}, settings, load));
  EXPECT_EQ(settings.tau_px, 0.25);
  EXPECT_EQ(settings.face_tiles, 12);
  EXPECT_EQ(settings.colour_quality, 70);
  EXPECT_EQ(settings.delta_views, 0);
  EXPECT_EQ(settings.void_target, 0.001);
  EXPECT_TRUE(settings.has_one_slope);
  EXPECT_EQ(settings.rate.cell_bytes, 300000);
  EXPECT_EQ(settings.rate.psnr_db, 37.5);
  EXPECT_EQ(settings.targets.void_share, 0.01);
  EXPECT_EQ(settings.targets.coding_psnr_db, 0);
  EXPECT_EQ(settings.near_triangles, 5000u);
  EXPECT_EQ(settings.finest_side_m, 2);
  EXPECT_EQ(load.metres_per_unit, 0.001);
  EXPECT_EQ(load.up, "z");
  EXPECT_EQ(load.shift, glm::dvec3(-84900, 0, 4.5));
  EXPECT_EQ(load.memory_limit_bytes, std::size_t{2} << 30);
}

TEST(SharedOptions, RefuseWhatCannotBeMeant) {
  for (const auto& [name, value] : std::vector<std::pair<const char*, const char*>>{
           {"--tau", "0"}, {"--tau", "nan"}, {"--face-tiles", "-1"}, {"--face-tiles", "65"}, {"--quality", "0"}, {"--quality", "101"},
           {"--delta-views", "33"}, {"--void-target", "2"}, {"--near-triangles", "0"}, {"--finest-side", "0"}, {"--finest-side", "-1"},
           {"--units", "0"}, {"--units", "inf"}, {"--shift", "a,b,c"}, {"--shift", "1,2"}, {"--shift", "nan,0,0"}, {"--memory-gb", "0"}}) {
    ImpostorSettings settings;
    LoadOptions load;
    EXPECT_FALSE(parse_shared({name, value}, settings, load)) << name << ' ' << value;
  }
}

TEST(ServerProgram, APortInUseIsSaidBeforeLoading) {
  asio::io_context context;
  const auto taken = listen_at(context.get_executor(), {"127.0.0.1", 0});
  ASSERT_TRUE(taken);
  const std::string address = "127.0.0.1:" + std::to_string(taken->local_endpoint().port());
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--listen", address.c_str()}), 1);
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--listen", "127.0.0.1:0", "--admin", address.c_str()}), 1);
  const std::string talk = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(talk.begin(), talk.end(), '\n'), 2) << talk;
}

TEST(ServerProgram, AMissingModelIsOne) { EXPECT_EQ(run({"--scene", "there-is-no-such-model.glb"}), 1); }

}  // namespace
}  // namespace farfield

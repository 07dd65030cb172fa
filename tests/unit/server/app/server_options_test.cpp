// SPDX-License-Identifier: Apache-2.0
// The command line of farfield-server, as far as it can be judged without serving.
#include <gtest/gtest.h>

#include "server/app/build_service.h"
#include "server/app/byte_size.h"
#include "server/app/server_program.h"

namespace farfield {
namespace {

int run(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "farfield-server");
  return run_server_program(static_cast<int>(arguments.size()), arguments.data());
}

TEST(ByteSize, ReadsSizesAsPeopleWriteThem) {
  for (const auto& [text, bytes] : std::vector<std::pair<const char*, std::size_t>>{
           {"0", 0}, {"1000", 1000}, {"1B", 1}, {"4GiB", std::size_t{4} << 30}, {"4g", std::size_t{4} << 30},
           {"1.5KiB", 1536}, {"512MB", 512'000'000}, {"2tib", std::size_t{2} << 40}}) {
    const auto size = parse_byte_size(text);
    ASSERT_TRUE(size) << text;
    EXPECT_EQ(*size, bytes) << text;
  }
  for (const char* text : {"", "GiB", "-1", "4GiBs", "4 apples", "nan", "1e30GiB"}) EXPECT_FALSE(parse_byte_size(text)) << text;
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
  EXPECT_EQ(run({"--scene", "a=pipes:1000:1", "--scene", "a=pipes:2000:1"}), 2);
  EXPECT_EQ(run({"--scene", "pipes:1000:1", "--up", "w"}), 2);
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_EQ(run({"--version"}), 0);
}

TEST(ServerProgram, AMissingModelIsOne) { EXPECT_EQ(run({"--scene", "there-is-no-such-model.glb"}), 1); }

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "client/app/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>
#include <sstream>
#include <vector>

namespace farfield::client {
namespace {

using ::testing::HasSubstr;

struct Parsed {
  tl::expected<ProgramOptions, int> options;
  std::string out, talk;
};

Parsed parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "farfield-client");
  std::ostringstream out, talk;
  auto options = parse_options(static_cast<int>(arguments.size()), arguments.data(), out, talk);
  return {std::move(options), out.str(), talk.str()};
}

TEST(ClientOptions, DefaultsAreAWindowOnThisMachine) {
  const Parsed parsed = parse({});
  ASSERT_TRUE(parsed.options) << parsed.talk;
  EXPECT_TRUE(parsed.options->is_window);
  EXPECT_EQ(parsed.options->server.port, kDefaultPort);
  EXPECT_EQ(parsed.options->display.width, 1280);
  EXPECT_EQ(parsed.options->memory_bytes, std::size_t{448} << 20);
  EXPECT_NEAR(parsed.options->display.fovy_rad, std::numbers::pi / 3, 1e-12);
  EXPECT_TRUE(parsed.options->link.is_none());
}

TEST(ClientOptions, EverythingCanBeSaid) {
  const Parsed parsed = parse({"--connect", "[::1]:7443", "--scene", "clinic", "--headless", "--lockstep", "--frames",
                               "12", "--frames-dir", "out", "--size", "640x360", "--fovy", "90", "--memory", "64MiB",
                               "--renderer", "gl", "--link", "rate=20mbit,delay=40ms", "--record", "walk.trace",
                               "--samples", "4", "--fade", "0.5", "--json", "-q"});
  ASSERT_TRUE(parsed.options) << parsed.talk;
  const ProgramOptions& options = *parsed.options;
  EXPECT_EQ(options.server.host, "::1");
  EXPECT_EQ(options.server.port, 7443);
  EXPECT_FALSE(options.is_window);
  EXPECT_TRUE(options.is_lockstep);
  EXPECT_EQ(options.frames, 12u);
  EXPECT_EQ(options.display.width, 640);
  EXPECT_EQ(options.display.height, 360);
  EXPECT_EQ(options.memory_bytes, std::size_t{64} << 20);
  EXPECT_EQ(options.renderer, RendererChoice::kGl);
  EXPECT_NEAR(options.link.rate_bits_per_second, 20e6, 1);
  EXPECT_EQ(options.samples_per_pixel, 4);
  EXPECT_EQ(options.fade_s, 0.5);
  EXPECT_TRUE(options.is_json);
}

TEST(ClientOptions, HelpAndVersionEndWithZero) {
  const Parsed help = parse({"--help"});
  ASSERT_FALSE(help.options);
  EXPECT_EQ(help.options.error(), 0);
  EXPECT_THAT(help.out, HasSubstr("Examples:"));
  const Parsed version = parse({"--version"});
  ASSERT_FALSE(version.options);
  EXPECT_EQ(version.options.error(), 0);
  EXPECT_THAT(version.out, HasSubstr("farfield-client "));
}

TEST(ClientOptions, WhatCannotBeMeantIsTwoAndNamesTheOption) {
  const std::vector<std::pair<std::vector<const char*>, const char*>> cases{
      {{"--size", "1280"}, "--size"},
      {{"--size", "0x720"}, "--size"},
      {{"--fovy", "180"}, "--fovy"},
      {{"--connect", "host:port"}, "--connect"},
      {{"--link", "rate=fast"}, "--link"},
      {{"--fade", "-1"}, "--fade"},
      {{"--memory", "10"}, "--memory"},
      {{"--trace", "no-such-file.trace"}, "no-such-file.trace"},
      {{"--lockstep"}, "--headless"},
      {{"--window", "--headless"}, "--headless"},
      {{"--renderer", "vulkan"}, "--renderer"},
      {{"--nonsense"}, "--nonsense"},
  };
  for (const auto& [arguments, named] : cases) {
    const Parsed parsed = parse(arguments);
    ASSERT_FALSE(parsed.options) << arguments.front();
    EXPECT_EQ(parsed.options.error(), kExitUsage) << arguments.front();
    EXPECT_THAT(parsed.talk, HasSubstr(named));
  }
}

TEST(ClientOptions, FlagsWinOverTheEnvironment) {
  ::setenv("FARFIELD_SCENE", "from the environment", 1);
  EXPECT_EQ(parse({}).options->scene, "from the environment");
  EXPECT_EQ(parse({"--scene", "flag"}).options->scene, "flag");
  ::unsetenv("FARFIELD_SCENE");
}

}  // namespace
}  // namespace farfield::client

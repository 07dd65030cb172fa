// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bench_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace farfield::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Parsed {
  tl::expected<ParsedCommand, int> command = tl::unexpected(0);
  std::string out, err;
};

Parsed parse(std::vector<const char*> words) {
  words.insert(words.begin(), "farfield-bench");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Parsed parsed;
  parsed.command = parse_command(static_cast<int>(words.size()), words.data());
  parsed.out = testing::internal::GetCapturedStdout(), parsed.err = testing::internal::GetCapturedStderr();
  return parsed;
}

TEST(BenchOptions, MethodsAreTakenInOrder) {
  const Parsed parsed = parse({"--scene", "house:100:1", "--trace", "t", "--methods", "farfield-gl,rays"});
  ASSERT_TRUE(parsed.command);
  EXPECT_THAT(parsed.command->bench.methods, ElementsAre("farfield-gl", "rays"));
}

TEST(BenchOptions, AnUnknownMethodIsOneLine) {
  const Parsed parsed = parse({"--scene", "house:100:1", "--trace", "t", "--methods", "rays,magic"});
  ASSERT_FALSE(parsed.command);
  EXPECT_EQ(parsed.command.error(), 2);
  EXPECT_EQ(parsed.err, "farfield-bench: --methods: there is no 'magic' (see --help)\n");
}

TEST(BenchOptions, SweepsMayBeGivenAgainAndCanStandAlone) {
  const Parsed parsed = parse({"--scene", "house:100:1", "--trace", "t", "--methods", "none", "--sweep", "rays:samples=1,4", "--sweep",
                               "farfield-cpu:quality=50,70"});
  ASSERT_TRUE(parsed.command) << parsed.err;
  EXPECT_TRUE(parsed.command->bench.methods.empty());
  ASSERT_EQ(parsed.command->bench.sweeps.size(), 2u);
  EXPECT_THAT(parsed.command->bench.sweeps[1].values, ElementsAre(50, 70));
}

TEST(BenchOptions, AWrongSweepIsOneLine) {
  const Parsed parsed = parse({"--scene", "house:100:1", "--trace", "t", "--sweep", "rays:samples=2"});
  ASSERT_FALSE(parsed.command);
  EXPECT_EQ(parsed.err, "farfield-bench: --sweep: rays:samples is 1|4|16, not 2\n");
}

TEST(BenchOptions, HelpListsMethodsAndKnobs) {
  const Parsed parsed = parse({"--help"});
  ASSERT_FALSE(parsed.command);
  EXPECT_EQ(parsed.command.error(), 0);
  for (const char* word : {"geometry-culled", "farfield-cpu", "rays per pixel", "void-target"}) EXPECT_THAT(parsed.out, HasSubstr(word));
}

}  // namespace
}  // namespace farfield::bench

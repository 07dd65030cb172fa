// SPDX-License-Identifier: Apache-2.0
#include "common/base/command_line.h"

#include <gtest/gtest.h>

#include <sstream>

namespace farfield {
namespace {

TEST(OneLine, KeepsTextAndReplacesWhatTerminalsWouldObey) {
  EXPECT_EQ(one_line("plain"), "plain");
  EXPECT_EQ(one_line("two\nlines\r\n"), "two?lines");
  EXPECT_EQ(one_line("\x1b[31mred"), "?[31mred");
  EXPECT_EQ(one_line(std::string_view("a\0b", 3)), "a?b");
  EXPECT_EQ(one_line("Fu\xc3\x9fweg \xe2\x82\xac"), "Fu\xc3\x9fweg \xe2\x82\xac");
  EXPECT_EQ(one_line("\xc3(\xff\xc2\x85\xed\xa0\x80"), "?(?????");
  EXPECT_EQ(one_line(""), "");
}

TEST(OneLine, ShortensInTheMiddle) {
  const std::string line = one_line("begin" + std::string(5000, 'x') + "end", 100);
  EXPECT_LT(line.size(), 120u);
  EXPECT_TRUE(line.starts_with("begin"));
  EXPECT_TRUE(line.ends_with("end"));
}

struct Outcome {
  std::optional<int> code;
  std::string out, talk;
};

Outcome parse(const std::vector<const char*>& arguments, std::ostream* full = nullptr) {
  CLI::App app{"Does things.", "farfield-thing"};
  double number = 0;
  std::uint64_t count = 0;
  app.add_option("--number", number)->check(number_between(0.5, 2));
  app.add_option("--count", count)->check(whole_number_between(1, 10));
  app.add_option("--word", "a word")->check(CLI::IsMember({"yes", "no"}));
  std::vector<const char*> all{"farfield-thing"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::ostringstream out, talk;
  const auto code = parse_command_line(app, static_cast<int>(all.size()), all.data(), full ? *full : out, talk);
  return {code, out.str(), talk.str()};
}

TEST(CommandLine, GoesOnWithWhatCanBeMeant) {
  for (const auto& arguments : std::vector<std::vector<const char*>>{{}, {"--number", "2"}, {"--count", "10"}, {"--number", "5e-1"}}) {
    EXPECT_FALSE(parse(arguments).code);
  }
}

TEST(CommandLine, WrongUsageIsOneLineAndTwo) {
  for (const auto& arguments : std::vector<std::vector<const char*>>{{"--number", "nan"}, {"--number", "0"}, {"--number", "-1"},
        {"--number", "inf"}, {"--number", "1x"}, {"--number", ""}, {"--number", "1e999"}, {"--count", "-1"}, {"--count", "0"},
        {"--count", "11"}, {"--count", "1.5"}, {"--count", "99999999999999999999"}, {"--nonsense"}, {"extra\nline"}, {"--number"}}) {
    const Outcome outcome = parse(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments.front();
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.talk.starts_with("farfield-thing: ")) << outcome.talk;
    EXPECT_EQ(std::count(outcome.talk.begin(), outcome.talk.end(), '\n'), 1) << outcome.talk;
    EXPECT_NE(outcome.talk.find("--help"), std::string::npos) << outcome.talk;
  }
}

TEST(CommandLine, HelpThatCannotBePrintedIsAFailure) {
  EXPECT_EQ(parse({"--help"}).code, 0);
  std::ostringstream full;
  full.setstate(std::ios::badbit);
  const Outcome outcome = parse({"--help"}, &full);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(std::count(outcome.talk.begin(), outcome.talk.end(), '\n'), 1);
}

}  // namespace
}  // namespace farfield

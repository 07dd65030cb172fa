// SPDX-License-Identifier: Apache-2.0
// No file of the project is compiled with flags that give up IEEE 754: -ffast-math and its parts let compilers drop NaN,
// reorder sums and switch denormals off for the whole process. The build's own list of compile commands is read.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace farfield {
namespace {

const char* const kForbidden[] = {"-ffast-math",
                                  "-Ofast",
                                  "-funsafe-math-optimizations",
                                  "-fassociative-math",
                                  "-freciprocal-math",
                                  "-ffinite-math-only",
                                  "-fno-signed-zeros",
                                  "-fno-trapping-math",
                                  "-fno-honor-nans",
                                  "-fno-honor-infinities",
                                  "-mdaz-ftz",
                                  "-fdenormal-fp-math"};

std::string forbidden_flag(const std::string& command) {
  std::istringstream words(command);
  for (std::string word; words >> word;)
    for (const std::string flag : kForbidden)
      if (word == flag || word.starts_with(flag + "=")) return word;
  return {};
}

TEST(BuildFlags, ForbiddenOnesAreFound) {
  EXPECT_EQ(forbidden_flag("g++ -O3 -ffast-math -c a.cpp"), "-ffast-math");
  EXPECT_EQ(forbidden_flag("g++ -Ofast -c a.cpp"), "-Ofast");
  EXPECT_EQ(forbidden_flag("clang++ -fdenormal-fp-math=preserve-sign -c a.cpp"), "-fdenormal-fp-math=preserve-sign");
  EXPECT_EQ(forbidden_flag("g++ -O3 -fno-math-errno -ffp-contract=off -c no-fast-math.cpp"), "");
}

TEST(BuildFlags, NoFileIsCompiledWithFastMath) {
  std::ifstream file(FARFIELD_BINARY_DIR "/compile_commands.json");
  ASSERT_TRUE(file) << "the build writes this list (CMAKE_EXPORT_COMPILE_COMMANDS)";
  const nlohmann::json commands = nlohmann::json::parse(file);
  std::size_t ours = 0;
  for (const nlohmann::json& entry : commands) {
    const std::string command = entry.at("command");
    EXPECT_EQ(forbidden_flag(command), "") << entry.at("file");
    // Scalar and vector code agree because neither contracts products and sums.
    EXPECT_NE(command.find("-ffp-contract=off"), std::string::npos) << entry.at("file");
    ours += std::string(entry.at("file")).find("/client/warp/") != std::string::npos;
  }
  EXPECT_GT(ours, 5u) << "the list should hold the project's files";
}

}  // namespace
}  // namespace farfield

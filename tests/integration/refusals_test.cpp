// SPDX-License-Identifier: Apache-2.0
// What cannot work is said in one clear line on standard error, with an exit code that is not zero.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <fstream>

#include "tests/integration/child_program.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

class RefusalsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "farfield-refusals-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return (folder_ / name).string();
  }

  std::filesystem::path folder_;
};

/// Runs to its end. Returns: standard error. Expects the exit code and silence on standard output.
std::string refused(const std::string& program, const std::vector<std::string>& arguments, int exit_code) {
  ChildProgram child(program, arguments);
  EXPECT_EQ(child.wait(60s), exit_code) << program << ": " << child.error_out();
  EXPECT_EQ(child.out(), "") << program;
  return child.error_out();
}

/// One line, ended, that names `what`.
void expect_one_line(const std::string& text, const std::string& what) {
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_NE(text.find(what), std::string::npos) << text;
}

TEST_F(RefusalsTest, AMissingModel) {
  expect_one_line(refused("farfield-server", {"--scene", "no/such/model.glb"}, 1), "no/such/model.glb: no such file");
}

TEST_F(RefusalsTest, AnEmptyModel) {
  const std::string file = write("empty.obj", "");
  expect_one_line(refused("farfield-server", {"--scene", file}, 1), "empty");
}

TEST_F(RefusalsTest, ATextCalledGlb) {
  const std::string file = write("letter.glb", "Dear reader, this is no model.\n");
  expect_one_line(refused("farfield-server", {"--scene", file}, 1), "letter.glb");
}

TEST_F(RefusalsTest, AModelWithoutATriangle) {
  const std::string file = write("points.obj", "v 0 0 0\nv 1 0 0\n");
  expect_one_line(refused("farfield-server", {"--scene", file}, 1), "points.obj");
}

TEST_F(RefusalsTest, WrongUsage) {
  const std::vector<std::pair<const char*, std::vector<std::string>>> cases{
      {"farfield-server", {"--no-such-flag"}},
      {"farfield-client", {"--no-such-flag"}},
      {"farfield-scene", {"--no-such-flag"}},
      {"farfield-trace", {"--no-such-flag"}},
      {"farfield-bake", {"--no-such-flag"}},
      {"farfield-bake", {"--scene", "pipes:2000:1", "--trace", "x.trace"}},
      {"farfield-bake", {"--scene", "pipes:2000:1", "--store", "x", "--trace", "x.trace", "--region", "0,0,0,1,1,1"}},
      {"farfield-bake", {"--scene", "pipes:2000:1", "--store", "x", "--region", "1,0,0,0,1,1"}},
      {"farfield-scene", {"info", "pipes:-5:1"}},
      {"farfield-scene", {"info", "pipes:0:1"}},
      {"farfield-scene", {"info", "castle:1000:1"}},
      {"farfield-scene", {"info", "two\nlines:1:1"}},
      {"farfield-scene", {"info", "x.obj", "--shift", "a,b,c"}},
      {"farfield-trace", {"generate", "pipes:2000:1", "-o", "x", "--seconds", "nan"}},
      {"farfield-trace", {"generate", "pipes:2000:1", "-o", "x", "--seed", "-1"}},
      {"farfield-server", {"--scene", "pipes:2000:1", "--listen", "127.0.0.1:99999"}},
      {"farfield-server", {"--scene", "pipes:2000:1", "--tau", "0"}},
      {"farfield-client", {"--frames", "-1"}},
      {"farfield-client", {"--fovy", "nan"}},
      {"farfield-client", {"--fps", "nan"}},
      {"farfield-client", {"--memory", "-1"}},
      {"farfield-client", {"--link", "rate=abc"}},
      {"farfield-client", {"--link", "delay=1e99s"}},
  };
  for (const auto& [program, arguments] : cases) {
    expect_one_line(refused(program, arguments, 2), std::string(program) + ": ");
  }
}

TEST_F(RefusalsTest, OutputsThatCannotBeWritten) {
  const std::string missing = (folder_ / "no" / "folder" / "out.glb").string();
  expect_one_line(refused("farfield-scene", {"generate", "pipes:2000:1", "-o", missing}, 1), missing);
  expect_one_line(refused("farfield-trace", {"generate", "pipes:2000:1", "-o", missing}, 1), missing);
  expect_one_line(refused("farfield-client", {"--connect", "127.0.0.1:1", "--headless", "--record", missing}, 1), missing);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(RefusalsTest, APortInUseAndASceneThatIsNotServed) {
  ChildProgram server("farfield-server", {"--scene", "plant=pipes:2000:1", "--listen", "127.0.0.1:0"});
  const auto line = server.wait_for_line("listening at ", 60s);
  ASSERT_TRUE(line) << server.error_out();
  const std::string endpoint = line->substr(std::string("listening at ").size());

  expect_one_line(refused("farfield-server", {"--scene", "pipes:2000:1", "--listen", endpoint}, 1), "is in use");

  expect_one_line(refused("farfield-client", {"--connect", endpoint, "--headless", "--scene", "castle"}, 1), "no scene 'castle'");
}

TEST_F(RefusalsTest, NobodyAtThePort) {
  // Port 1 is reserved and unused; --quiet keeps the note about trying again away.
  expect_one_line(refused("farfield-client", {"--connect", "127.0.0.1:1", "--headless", "--timeout", "1", "--quiet"}, 1), "127.0.0.1:1");
}

TEST_F(RefusalsTest, ATraceThatIsNone) {
  const std::string file = write("walk.trace", "0 1 2 three 0 0 0 1\n");
  const std::string said = refused("farfield-client", {"--connect", "127.0.0.1:1", "--headless", "--trace", file, "--timeout", "1"}, 1);
  expect_one_line(said, "walk.trace:1");
}

}  // namespace
}  // namespace farfield

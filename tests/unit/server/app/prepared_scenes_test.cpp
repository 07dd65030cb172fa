// SPDX-License-Identifier: Apache-2.0
// The second start reads what the first one made, and never anything else.
#include "server/app/prepared_scenes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>

#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using testing::Contains;
using testing::HasSubstr;

class PreparedScenesTest : public testing::Test {
 protected:
  struct Start {
    ContentHash hash = 0;
    std::optional<glm::dvec3> standing;
    std::vector<std::string> log;
    bool was_read() const {
      for (const std::string& line : log) {
        if (line.find("prepared earlier") != line.npos) return true;
      }
      return false;
    }
  };
  /// A server's start and end.
  Start start(const std::string& scene, std::uint64_t capacity_bytes = std::uint64_t{1} << 30, const LoadOptions& load = {}) {
    Start result;
    std::mutex mutex;
    PreparedScenes scenes(folder_.path() / "store", capacity_bytes);
    const auto prepared = scenes.open(scene, load, [&](const std::string& line) {
      const std::lock_guard lock(mutex);
      result.log.push_back(line);
    });
    EXPECT_TRUE(prepared.has_value()) << prepared.error().message;
    scenes.finish();
    if (prepared) result.hash = prepared->scene->hash(), result.standing = prepared->standing;
    return result;
  }
  std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> result;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "store" / "prepared", ignored)) result.push_back(entry.path());
    return result;
  }
  /// A room, and time enough since that a start sees it was written before.
  std::string write_room(float width) {
    std::string text = "mtllib room.mtl\nusemtl a\n";
    for (const auto& [x, y, z] : {std::array<float, 3>{0, 0, 0}, {width, 0, 0}, {width, 0, 8}, {0, 0, 8}, {0, 4, 0}, {width, 4, 0}})
      text += fmt::format("v {} {} {}\n", x, y, z);
    const std::string path = folder_.write("room.obj", text + "f 1 4 3 2\nf 1 2 6 5\n");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return path;
  }
  TemporaryFolder folder_;
};

TEST_F(PreparedScenesTest, TheSecondStartReadsWhatTheFirstMade) {
  const Start first = start("house:3000:1"), second = start("house:3000:1");
  EXPECT_FALSE(first.was_read());
  EXPECT_TRUE(second.was_read());
  EXPECT_EQ(first.hash, second.hash);
  ASSERT_TRUE(first.standing.has_value());
  EXPECT_EQ(first.standing, second.standing);
  EXPECT_FALSE(start("house:3000:2").was_read()) << "another scene";
}

TEST_F(PreparedScenesTest, AChangedModelIsReadAnew) {
  const Start first = start(write_room(6));
  EXPECT_TRUE(start((folder_.path() / "room.obj").string()).was_read());
  const Start changed = start(write_room(7));
  EXPECT_FALSE(changed.was_read());
  EXPECT_NE(first.hash, changed.hash);
  EXPECT_THAT(changed.log, Contains(HasSubstr("room.obj has changed")));
  EXPECT_TRUE(start((folder_.path() / "room.obj").string()).was_read());
}

TEST_F(PreparedScenesTest, AMaterialLibraryThatAppearsIsAChange) {
  const std::string room = write_room(6);
  const Start first = start(room);
  EXPECT_THAT(first.log, Contains(HasSubstr("material library"))) << "it is missing, and that is said";
  const Start second = start(room);
  EXPECT_TRUE(second.was_read());
  EXPECT_THAT(second.log, Contains(HasSubstr("material library"))) << "at every start";
  folder_.write("room.mtl", "newmtl a\nKd 1 0 0\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const Start third = start(room);
  EXPECT_FALSE(third.was_read());
  EXPECT_NE(third.hash, first.hash);
}

TEST_F(PreparedScenesTest, OtherUnitsAreAnotherScene) {
  const std::string room = write_room(6);
  const Start metres = start(room);
  LoadOptions feet;
  feet.metres_per_unit = 0.3048;
  const Start other = start(room, std::uint64_t{1} << 30, feet);
  EXPECT_FALSE(other.was_read());
  EXPECT_NE(other.hash, metres.hash);
  EXPECT_TRUE(start(room).was_read()) << "both are kept";
}

TEST_F(PreparedScenesTest, ADamagedFileIsReplaced) {
  const Start first = start("house:3000:1");
  ASSERT_EQ(files().size(), 1u);
  const auto path = files().front();
  const auto size = std::filesystem::file_size(path);
  for (const std::uintmax_t place : {size / 3, size - 3}) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(place));
    const char changed = static_cast<char>(file.get() ^ 1);
    file.seekp(static_cast<std::streamoff>(place));
    file.put(changed);
    file.close();
    const Start second = start("house:3000:1");
    EXPECT_FALSE(second.was_read());
    EXPECT_THAT(second.log, Contains(HasSubstr("damaged")));
    EXPECT_EQ(second.hash, first.hash);
    EXPECT_TRUE(start("house:3000:1").was_read());
  }
  std::filesystem::resize_file(path, size / 2);
  EXPECT_FALSE(start("house:3000:1").was_read());
}

TEST_F(PreparedScenesTest, AFileOfAnotherBuildIsReplaced) {
  start("house:3000:1");
  std::fstream file(files().front(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(8);
  file.put('z');  // no digit of a fingerprint
  file.close();
  const Start second = start("house:3000:1");
  EXPECT_FALSE(second.was_read());
  EXPECT_THAT(second.log, Contains(HasSubstr("another build")));
  EXPECT_TRUE(start("house:3000:1").was_read());
}

TEST_F(PreparedScenesTest, WhatDoesNotFitIsNotKeptAndTheOldestGoes) {
  EXPECT_THAT(start("house:3000:1", 1000).log, Contains(HasSubstr("raise --store-bytes")));
  EXPECT_TRUE(files().empty());
  start("house:3000:1");
  const auto size = std::filesystem::file_size(files().front());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // so that times of use differ
  start("house:3000:2", 2 * size + size / 2);
  EXPECT_EQ(files().size(), 2u);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(start("house:3000:1", 2 * size + size / 2).was_read());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  start("house:3000:3", 2 * size + size / 2);
  EXPECT_EQ(files().size(), 2u);
  EXPECT_TRUE(start("house:3000:1").was_read()) << "used after the other";
}

TEST_F(PreparedScenesTest, AFolderThatCannotBeWrittenCostsNothingButTheNextStart) {
  folder_.write("store", "a file where the folder should be");
  const Start first = start("house:3000:1");
  EXPECT_NE(first.hash, 0u);
  EXPECT_THAT(first.log, Contains(HasSubstr("not prepared for the next start")));
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "common/base/complete_file.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <fstream>
#include <iterator>

namespace farfield {
namespace {

namespace fs = std::filesystem;

class CompleteFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "farfield-complete-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  static std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }
  std::size_t entries() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {})); }

  fs::path folder_;
};

TEST_F(CompleteFileTest, AppearsWholeOrNotAtAll) {
  const fs::path path = folder_ / "data";
  const std::uint8_t bytes[] = {1, 2, 3};
  {
    Result<CompleteFile> file = CompleteFile::create(path);
    ASSERT_TRUE(file);
    file->write(bytes);
    EXPECT_FALSE(fs::exists(path)) << "not before commit()";
  }
  EXPECT_TRUE(fs::is_empty(folder_)) << "abandoned: removed";
  {
    Result<CompleteFile> file = CompleteFile::create(path);
    ASSERT_TRUE(file);
    file->write(bytes);
    EXPECT_TRUE(file->commit());
  }
  EXPECT_EQ(fs::file_size(path), 3u);
  EXPECT_EQ(entries(), 1u);
}

TEST_F(CompleteFileTest, SaysWhatKeepsItFromBeingWritten) {
  for (const fs::path& path : {folder_, folder_ / "no" / "folder", fs::path()}) {
    const Status written = write_complete_file(path, "text");
    ASSERT_FALSE(written) << path;
    EXPECT_EQ(written.error().code, ErrorCode::kIo);
    EXPECT_FALSE(check_file_can_be_written(path)) << path;
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(CompleteFileTest, AFailureKeepsWhatWasThere) {
  const fs::path path = folder_ / "data";
  ASSERT_TRUE(write_complete_file(path, "old"));
  {
    Result<CompleteFile> file = CompleteFile::create(path);
    ASSERT_TRUE(file);
    file->write(ByteView(reinterpret_cast<const std::uint8_t*>("new"), 3));
  }
  EXPECT_EQ(text_of(path), "old");
  EXPECT_TRUE(check_file_can_be_written(path));
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(CompleteFileTest, ALinkStaysALink) {
  ASSERT_TRUE(write_complete_file(folder_ / "target", "old"));
  fs::create_symlink("target", folder_ / "link");
  fs::create_symlink("later", folder_ / "dangling");
  ASSERT_TRUE(write_complete_file(folder_ / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(text_of(folder_ / "target"), "new");
  ASSERT_TRUE(write_complete_file(folder_ / "dangling", "made"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "dangling"));
  EXPECT_EQ(text_of(folder_ / "later"), "made");
}

TEST_F(CompleteFileTest, ADeviceIsWrittenNotReplaced) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  fs::create_symlink("/dev/full", folder_ / "full");
  fs::create_symlink("/dev/null", folder_ / "null");
  const Status full = write_complete_file(folder_ / "full", "text");
  ASSERT_FALSE(full);
  EXPECT_NE(full.error().message.find("No space left"), std::string::npos) << full.error().message;
  EXPECT_TRUE(write_complete_file(folder_ / "null", "text"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "full"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_EQ(entries(), 2u);
}

}  // namespace
}  // namespace farfield

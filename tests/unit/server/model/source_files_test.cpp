// SPDX-License-Identifier: Apache-2.0
#include "server/model/source_files.h"

#include <gtest/gtest.h>

#include <thread>

#include "server/model/import_file.h"
#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using std::chrono::system_clock;

// Later than anything a test has written so far.
constexpr std::chrono::hours kLater{1};

class SourceFilesTest : public testing::Test {
 protected:
  std::vector<SourceFile> describe(const std::vector<std::string>& names) {
    const auto sources = describe_sources(names, system_clock::now() + kLater);
    EXPECT_TRUE(sources.has_value());
    return sources.value_or(std::vector<SourceFile>{});
  }
  TemporaryFolder folder_;
};

TEST_F(SourceFilesTest, UntouchedFilesAreTheSame) {
  const std::string model = folder_.write("a.obj", "v 0 0 0\n");
  const auto sources = describe({model, (folder_.path() / "missing.mtl").string(), model});
  EXPECT_EQ(sources.size(), 2u) << "each file once";
  EXPECT_EQ(find_changed(sources), "");
}

TEST_F(SourceFilesTest, AChangedFileIsFoundThoughItsSizeAndTimeAreAsBefore) {
  const std::string model = folder_.write("a.obj", "v 0 0 0\n");
  const auto sources = describe({model});
  const auto time = std::filesystem::last_write_time(model);
  folder_.write("a.obj", "v 0 0 1\n");
  std::filesystem::last_write_time(model, time);
  EXPECT_EQ(find_changed(sources), model);
}

TEST_F(SourceFilesTest, ACopyWithTheSameContentIsTheSame) {
  const std::string model = folder_.write("a.obj", "v 0 0 0\n");
  const auto sources = describe({model});
  std::filesystem::remove(model);
  folder_.write("a.obj", "v 0 0 0\n");
  EXPECT_EQ(find_changed(sources), "");
}

TEST_F(SourceFilesTest, AFileThatAppearsOrGoesIsAChange) {
  const std::string missing = (folder_.path() / "late.png").string(), there = folder_.write("there.png", "x");
  const auto sources = describe({missing, there});
  folder_.write("late.png", "y");
  EXPECT_EQ(find_changed(sources), missing);
  std::filesystem::remove(missing);
  std::filesystem::remove(there);
  EXPECT_EQ(find_changed(sources), there);
}

TEST_F(SourceFilesTest, AFileWrittenWhileItWasReadIsNotVouchedFor) {
  const auto sources = describe_sources({folder_.write("a.obj", "v 0 0 0\n")}, system_clock::now() - std::chrono::seconds(1));
  ASSERT_FALSE(sources.has_value());
  EXPECT_EQ(sources.error().code, ErrorCode::kUnavailable);
}

TEST_F(SourceFilesTest, SurvivesBeingWritten) {
  const auto sources = describe({folder_.write("a.obj", "v 0 0 0\n"), (folder_.path() / "b").string()});
  Bytes bytes;
  MemoryImageWriter out([&](ByteView block) { bytes.assign(block.begin(), block.end()); });
  write_sources(sources, out);
  out.flush();
  MemoryImageReader in(bytes);
  const auto again = read_sources(in);
  ASSERT_TRUE(in.is_valid() && in.is_at_end());
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(find_changed(again), "");
  folder_.write("a.obj", "v 1 0 0\n");
  EXPECT_NE(find_changed(again), "");
}

/// Every file a reader opens or looks for is one of the model's sources.
TEST_F(SourceFilesTest, ReadersNameMaterialsTexturesAndBuffers) {
  folder_.write("m.mtl", "newmtl a\nmap_Kd skin.png\n");
  const std::string obj = folder_.write("m.obj", "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto model = import_file(obj);
  ASSERT_TRUE(model.has_value());
  const auto sources = describe(model->sources);
  ASSERT_EQ(sources.size(), 3u);
  EXPECT_TRUE(sources[0].exists && sources[1].exists && !sources[2].exists) << "m.mtl, m.obj, skin.png that is missing";

  const std::string gltf = folder_.write(
      "g.gltf",
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("buffers":[{"uri":"g.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]})");
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string buffer = folder_.write("g.bin", {reinterpret_cast<const char*>(corners), sizeof(corners)});
  const auto scene = import_file(gltf);
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  bool has_buffer = false;
  for (const SourceFile& source : describe(scene->sources)) has_buffer = has_buffer || (source.exists && source.path == buffer);
  EXPECT_TRUE(has_buffer);
}

}  // namespace
}  // namespace farfield

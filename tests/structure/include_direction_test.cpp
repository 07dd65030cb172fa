// SPDX-License-Identifier: Apache-2.0
// The tree shows the way of the data: a stage includes only itself and stages before it, common includes neither
// side, and server and client never include each other. Also what every source file must begin with.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace farfield {
namespace {

namespace fs = std::filesystem;

struct Side {
  std::string name;
  std::vector<std::string> stages;  // each may include those before it
};

// On the client, bytes flow session → decode → store, but the session drives the other two, so it includes them.
const std::vector<Side> kSides{
    {"common",
     {"base", "math", "cells", "shading", "image", "impostor", "geometry", "codec", "net", "predict", "trace"}},
    {"server",
     {"model", "scene", "visibility", "cells", "impostor", "encode", "store", "schedule", "access", "session", "admin", "app"}},
    {"client", {"decode", "store", "session", "load", "gl", "near", "warp", "near_cpu", "warp_gl", "frame", "input", "app"}},
};

// Nouns several stages hand on: headers that include no stage of their own side, and so count as its beginning.
const std::vector<std::string> kNouns{"client/store/leaf_view.h"};

struct Place {
  const Side* side = nullptr;
  std::size_t stage = 0;
};

// Where "side/stage/file" belongs, nothing if it is no stage of ours.
std::optional<Place> place_of(const std::string& path) {
  for (const Side& side : kSides) {
    if (!path.starts_with(side.name + "/")) continue;
    const std::string rest = path.substr(side.name.size() + 1);
    const std::string stage = rest.substr(0, rest.find('/'));
    const auto at = std::find(side.stages.begin(), side.stages.end(), stage);
    if (at == side.stages.end()) return std::nullopt;
    return Place{&side, static_cast<std::size_t>(at - side.stages.begin())};
  }
  return std::nullopt;
}

bool is_noun(const std::string& path) {
  return std::find(kNouns.begin(), kNouns.end(), path) != kNouns.end();
}

// Returns: why `file` must not include `included`; empty if it may.
std::string objection(const std::string& file, const std::string& included) {
  const auto from = place_of(file);
  const bool is_ours = std::any_of(kSides.begin(), kSides.end(),
                                   [&](const Side& side) { return included.starts_with(side.name + "/"); });
  if (!is_ours) return {};
  const auto to = place_of(included);
  if (!from || !to) return file + " or " + included + " is in a folder that is no stage: add it to this test's order";
  if (to->side->name == "common" && from->side->name != "common") return {};
  if (to->side != from->side) return file + " includes " + included + ": another side";
  if (to->stage > from->stage && !is_noun(included)) return file + " includes " + included + ": a later stage";
  if (is_noun(file) && !is_noun(included)) return file + " is a noun of its side and includes one of its stages";
  return {};
}

std::vector<std::string> lines_of(const fs::path& path) {
  std::ifstream stream(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<fs::path> sources_under(const fs::path& folder) {
  std::vector<fs::path> sources;
  if (!fs::exists(folder)) return sources;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".h" || extension == ".cpp")) sources.push_back(entry.path());
  }
  return sources;
}

const fs::path kRoot = FARFIELD_SOURCE_DIR;

TEST(Structure, TheRuleItselfObjects) {
  EXPECT_EQ(objection("server/store/a.h", "server/encode/b.h"), "");
  EXPECT_EQ(objection("server/store/a.h", "server/store/b.h"), "");
  EXPECT_EQ(objection("server/store/a.h", "common/base/b.h"), "");
  EXPECT_EQ(objection("server/store/a.h", "embree3/rtcore.h"), "");
  EXPECT_EQ(objection("client/decode/a.h", "client/store/leaf_view.h"), "");
  EXPECT_NE(objection("client/decode/a.h", "client/store/payload_store.h"), "");
  EXPECT_NE(objection("server/store/a.h", "server/schedule/b.h"), "");
  EXPECT_NE(objection("common/base/a.h", "common/cells/b.h"), "");
  EXPECT_NE(objection("common/base/a.h", "server/model/b.h"), "");
  EXPECT_NE(objection("server/app/a.h", "client/decode/b.h"), "");
  EXPECT_NE(objection("client/app/a.h", "server/model/b.h"), "");
  EXPECT_NE(objection("server/app/a.h", "server/utils/b.h"), "");
  EXPECT_NE(objection("client/store/leaf_view.h", "client/store/payload_store.h"), "");
}

TEST(Structure, StagesIncludeOnlyEarlierStages) {
  const std::regex include(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  std::size_t seen = 0;
  for (const Side& side : kSides) {
    for (const fs::path& source : sources_under(kRoot / side.name)) {
      const std::string file = fs::relative(source, kRoot).generic_string();
      for (const std::string& line : lines_of(source)) {
        std::smatch match;
        if (!std::regex_search(line, match, include)) continue;
        ++seen;
        const std::string why = objection(file, match[1]);
        EXPECT_TRUE(why.empty()) << why;
      }
    }
  }
  EXPECT_GT(seen, 100u) << "the sources were not found under " << kRoot;
}

TEST(Structure, EverySourceNamesItsLicenceAndEveryHeaderIsGuarded) {
  for (const char* folder : {"common", "server", "client", "tests"}) {
    for (const fs::path& source : sources_under(kRoot / folder)) {
      const auto lines = lines_of(source);
      ASSERT_FALSE(lines.empty()) << source;
      EXPECT_EQ(lines[0], "// SPDX-License-Identifier: Apache-2.0") << source;
      if (source.extension() == ".h") {
        EXPECT_NE(std::find(lines.begin(), lines.end(), "#pragma once"), lines.end()) << source;
      }
    }
  }
}

}  // namespace
}  // namespace farfield

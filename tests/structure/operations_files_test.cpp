// SPDX-License-Identifier: Apache-2.0
// Files for operators speak of what exists: every metric that an alert or a dashboard names is one the server exports.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace {

const std::filesystem::path kRoot = FARFIELD_SOURCE_DIR;

std::string read(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::set<std::string> names_in(const std::string& text, const std::regex& pattern) {
  std::set<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) names.insert(match->str(1));
  return names;
}

TEST(OperationsFiles, NameOnlyMetricsThatAreExported) {
  std::set<std::string> exported;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "server")) {
    if (entry.path().extension() == ".cpp") exported.merge(names_in(read(entry.path()), std::regex("\"(farfield_[a-z_]+)\"")));
  }
  ASSERT_GT(exported.size(), 30u);
  std::size_t used = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "deploy")) {
    const std::string extension = entry.path().extension();
    if (extension != ".yml" && extension != ".json") continue;
    for (std::string name : names_in(read(entry.path()), std::regex("\\b(farfield_[a-z_]+)\\b"))) {
      // A histogram's parts.
      name = std::regex_replace(name, std::regex("_(bucket|count|sum)$"), "");
      EXPECT_TRUE(exported.contains(name)) << entry.path() << " names " << name;
      ++used;
    }
  }
  EXPECT_GT(used, 5u);
}

TEST(OperationsFiles, ScriptsNameOnlyMetricsThatAreExported) {
  std::string sources;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "server")) {
    if (entry.path().extension() == ".cpp") sources += read(entry.path());
  }
  for (const std::string& name : names_in(read(kRoot / "deploy" / "scale_out.sh"), std::regex("\\bmetric (farfield_[a-z_]+)"))) {
    EXPECT_NE(sources.find('"' + name + '"'), sources.npos) << "scale_out.sh asks for " << name;
  }
}

}  // namespace

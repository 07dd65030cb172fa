// SPDX-License-Identifier: Apache-2.0
#include "server/model/import_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace farfield {
namespace {

using testing::HasSubstr;

ImportReport report_of_twenty_warnings() {
  Model model;
  model.materials.emplace_back();
  model.meshes.push_back({.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  for (int i = 0; i < 1500; ++i) model.instances.push_back({0, glm::dmat4(1)});
  model.instances[3].world_from_mesh[3] = glm::dvec4(100, 0, 0, 1);
  for (int i = 0; i < 20; ++i) model.warnings.push_back("warning " + std::to_string(i));
  model.warnings[0] += "\xff";  // names in files may be in any encoding
  return make_import_report("x.city.json", model, {.shift = {1, 0, 0}}, 1.5);
}

TEST(ImportReport, FitsOneScreen) {
  const std::string text = report_text(report_of_twenty_warnings());
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 25);
  EXPECT_THAT(text, HasSubstr("1,500 drawn, 1 stored"));
  EXPECT_THAT(text, HasSubstr("(0.000 0.000 0.000) .. (101.000 1.000 0.000) m"));
  EXPECT_THAT(text, HasSubstr("and 8 more"));
}

TEST(ImportReport, JsonHoldsEverything) {
  const nlohmann::json json = nlohmann::json::parse(report_json(report_of_twenty_warnings()));
  EXPECT_EQ(json["drawn_triangles"], 1500);
  EXPECT_EQ(json["stored_triangles"], 1);
  EXPECT_EQ(json["warnings"].size(), 20u);
  EXPECT_EQ(json["bounds_max_m"][0], 101.0);
  EXPECT_EQ(json["seconds"], 1.5);
  EXPECT_GT(json["peak_memory_bytes"], 1000000);
}

}  // namespace
}  // namespace farfield

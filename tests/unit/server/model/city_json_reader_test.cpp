// SPDX-License-Identifier: Apache-2.0
#include "server/model/city_json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kVertices =
    R"("vertices":[[0,0,0],[1000,0,0],[1000,1000,0],[0,1000,0],[0,0,1000],[1000,0,1000],[1000,1000,1000],[0,1000,1000]])";
constexpr const char* kTransform =
    R"("transform":{"scale":[0.001,0.001,0.001],"translate":[84616.468,447422.999,-0.452]})";
constexpr const char* kCube = R"([[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]])";

class CityJsonTest : public testing::Test {
 protected:
  Result<Model> read(const std::string& objects) {
    return read_city_json(
        folder_.write("tile.city.json", fmt::format(R"({{"type":"CityJSON","version":"1.1",{},{},"CityObjects":{}}})",
                                                    kTransform, kVertices, objects)));
  }
  TemporaryFolder folder_;
};

TEST_F(CityJsonTest, ReadsASolidInItsPlaceWithColoursBySurface) {
  const auto model = read(fmt::format(
      R"({{"a":{{"type":"Building","geometry":[{{"type":"Solid","lod":"2.2","boundaries":[{}],
          "semantics":{{"surfaces":[{{"type":"RoofSurface"}},{{"type":"WallSurface"}}],"values":[[null,0,1,1,1,1]]}}}}]}}}})",
      kCube));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 12u);
  EXPECT_EQ(model->materials.size(), 3u);
  const Box box = model->bounds();
  EXPECT_LT(glm::length(box.min - glm::dvec3(84616.468, 447422.999, -0.452)), 1e-6);
  EXPECT_LT(glm::length(box.max - glm::dvec3(84617.468, 447423.999, 0.548)), 1e-6);
}

TEST_F(CityJsonTest, TakesTheFinestGeometryAndPartsInsteadOfTheWhole) {
  const auto model = read(fmt::format(
      R"({{"b":{{"type":"Building","children":["p"],"geometry":[{{"type":"MultiSurface","lod":"0","boundaries":[[[0,1,2,3]]]}}]}},
          "p":{{"type":"BuildingPart","parents":["b"],"geometry":[
             {{"type":"MultiSurface","lod":1,"boundaries":[[[0,1,2]]]}},{{"type":"Solid","lod":"2.2","boundaries":[{}]}}]}}}})",
      kCube));
  ASSERT_TRUE(model);
  EXPECT_EQ(model->drawn_triangles(), 12u);
}

TEST_F(CityJsonTest, CutsHoles) {
  const auto model = read_city_json(folder_.write(
      "hole.json",
      R"({"type":"CityJSON","version":"2.0","vertices":[[0,0,0],[4,0,0],[4,4,0],[0,4,0],[1,1,0],[1,3,0],[3,3,0],[3,1,0]],
          "CityObjects":{"r":{"type":"Road","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2,3],[4,5,6,7]]]}]}}})"));
  ASSERT_TRUE(model);
  double area = 0;
  const Mesh& mesh = model->meshes.at(0);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  EXPECT_NEAR(area, 12, 1e-5);
}

TEST_F(CityJsonTest, ReadsSequencesWithVerticesOfTheirOwn) {
  const auto model = read_city_json(
      folder_.write("tile.city.jsonl", fmt::format(
                                           R"({{"type":"CityJSON","version":"1.1","CityObjects":{{}},"vertices":[],{}}}
{{"type":"CityJSONFeature",{},"CityObjects":{{"a":{{"type":"Building","geometry":[{{"type":"Solid","lod":"1","boundaries":[{}]}}]}}}}}}

{{"type":"CityJSONFeature","vertices":[[0,0,0],[5000,0,0],[0,5000,0]],"CityObjects":{{"b":{{"type":"WaterBody","geometry":[{{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}}]}}}}}}
)",
                                           kTransform, kVertices, kCube)));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 13u);
}

TEST_F(CityJsonTest, DropsAndCountsWhatItCannotUse) {
  const auto model = read(
      R"({"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]],[[0,1,99]],[[-1,1,2]],[["x"]],7,[[0,1]]]}]},
          "t":{"type":"CityFurniture","geometry":[{"type":"GeometryInstance","template":0,"boundaries":[0]}]},
          "n":5,"e":{"type":"Road"},"g":{"type":"Road","geometry":[{"type":"Solid","boundaries":3}]}})");
  ASSERT_TRUE(model);
  EXPECT_EQ(model->drawn_triangles(), 1u);
  EXPECT_THAT(model->warnings, Contains("dropped surfaces without area or that name missing vertices: 5"));
  EXPECT_THAT(model->warnings, Contains(HasSubstr("kinds that are not read (templates, points, lines): 1")));
}

TEST_F(CityJsonTest, SaysWhatIsWrong) {
  const auto message = [&](const std::string& text) {
    const auto model = read_city_json(folder_.write("bad.json", text));
    return model ? std::string("no error") : model.error().message;
  };
  EXPECT_THAT(message("{\"type\":\"Feature"), HasSubstr("line 1 is damaged JSON"));
  EXPECT_THAT(message("[1,2]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(message("{\"type\":\"FeatureCollection\"}"), HasSubstr("not CityJSON (its type is 'FeatureCollection')"));
  EXPECT_THAT(message("{\"type\":\"CityJSON\"}"), HasSubstr("has no CityObjects"));
  EXPECT_THAT(message("{\"type\":\"CityJSON\",\"transform\":{\"scale\":[1]}}"), HasSubstr("transform"));
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
// Files through the whole import: the import program is started for each.
#include "server/model/load_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using testing::Contains;
using testing::HasSubstr;

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text.push_back(i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=');
  }
  return text;
}

/// A quad in two triangles, used by three nodes (one under a scaled parent), `index` being its last vertex number.
std::string gltf(std::uint16_t last_index, const std::string& material, const std::string& extra_accessor = "") {
  const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::uint16_t indices[] = {0, 1, 2, 0, 2, last_index};
  std::string binary(reinterpret_cast<const char*>(positions), sizeof(positions));
  binary.append(reinterpret_cast<const char*>(indices), sizeof(indices));
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
    "nodes":[{"mesh":0},{"scale":[2,2,2],"children":[2,3]},{"mesh":0,"translation":[10,0,0]},{"mesh":0,"translation":[0,0,-5]}],
    "materials":[)" +
         material + R"(],
    "meshes":[{"name":"quad","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
      {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"})" +
         extra_accessor + R"(],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
    "buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)" +
         base64(binary) + R"("}]})";
}

class LoadModelTest : public testing::Test {
 protected:
  Result<Model> load(const std::string& name, std::string_view content, const LoadOptions& options = {}) {
    return load_model(folder_.write(name, content), options);
  }
  /// The error's message, after checking that it is one line that names the file.
  std::string failure(const std::string& name, std::string_view content) {
    const Result<Model> model = load(name, content);
    if (model) return "no error";
    EXPECT_EQ(model.error().message.find('\n'), std::string::npos) << model.error().message;
    EXPECT_THAT(model.error().message, HasSubstr(name));
    return model.error().message;
  }
  TemporaryFolder folder_;
};

TEST_F(LoadModelTest, GltfKeepsSharedMeshesAndComposesNodes) {
  const auto model = load("quad.gltf", gltf(3, R"({"pbrMetallicRoughness":{"baseColorFactor":[0.5,0,1,1]}})"));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->meshes.size(), 1u);
  EXPECT_EQ(model->instances.size(), 3u);
  EXPECT_EQ(model->drawn_triangles(), 6u);
  EXPECT_EQ(model->bounds().max, glm::dvec3(22, 2, 0));
  EXPECT_EQ(model->bounds().min, glm::dvec3(0, 0, -10));
  EXPECT_EQ(model->materials.at(0).base_colour, glm::u8vec4(188, 0, 255, 255)) << "factors are linear light";
  EXPECT_TRUE(model->warnings.empty());
}

TEST_F(LoadModelTest, GltfCountsWhatWasDropped) {
  const auto model = load("index.gltf", gltf(77, "{}"));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 3u);
  EXPECT_THAT(model->warnings, Contains(HasSubstr("naming missing vertices: 1")));
}

TEST_F(LoadModelTest, GltfGlassIsAbsent) {
  const std::string glass = R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.3]}})";
  EXPECT_THAT(failure("glass.gltf", gltf(3, glass)), HasSubstr("every triangle is see-through"));
  const std::string dense = R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.7]}})";
  const auto model = load("dense.gltf", gltf(3, dense));
  ASSERT_TRUE(model);
  EXPECT_EQ(model->drawn_triangles(), 6u);
  EXPECT_THAT(model->warnings, Contains(HasSubstr("blended materials")));
}

TEST_F(LoadModelTest, Ply) {
  const auto model = load(
      "t.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "red\n"
      "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 51\n3 0 1 2\n");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 1u);
  ASSERT_EQ(model->meshes[0].colours.size(), 3u);
  EXPECT_EQ(model->meshes[0].colours[2], glm::u8vec4(0, 0, 51, 255));
}

TEST_F(LoadModelTest, StlIsWelded) {
  std::string text = "solid s\n";
  for (const char* third : {"1 1 0", "0 1 0"}) {
    text += std::string("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex ") +
            (third[0] == '1' ? "1 0 0" : "1 1 0") + "\nvertex " + third + "\nendloop\nendfacet\n";
  }
  const auto model = load("t.stl", text + "endsolid s\n");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 2u);
  EXPECT_EQ(model->meshes[0].positions.size(), 4u);
}

TEST_F(LoadModelTest, Off) {
  const auto model = load("t.off", "OFF\n# four corners\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 2u);
}

TEST_F(LoadModelTest, Ac3dWithCrease) {
  const auto model = load("t.ac",
                          "AC3Db\nMATERIAL \"m\" rgb 1 0.5 0 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT "
                          "world\nkids 1\nOBJECT poly\n"
                          "loc 5 0 0\nnumvert 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 4\n0 0 "
                          "0\n1 0 0\n2 0 0\n3 0 0\nkids 0\n");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 2u);
  EXPECT_EQ(model->bounds().max, glm::dvec3(6, 1, 0));
  EXPECT_EQ(model->materials[static_cast<std::size_t>(model->meshes[0].material)].base_colour,
            glm::u8vec4(255, 128, 0, 255));
}

TEST_F(LoadModelTest, ColladaBringsItsUpAxis) {
  const auto model = load(
      "t.dae", R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 0 2</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->drawn_triangles(), 1u);
  EXPECT_NEAR(model->bounds().max.y, 2, 1e-6) << "the file's z is up";
}

TEST_F(LoadModelTest, UnitsUpAndShiftWorkInDouble) {
  const std::string text =
      "v 84616468 447423001 -15002\nv 84617468 447423001 -15002\nv 84616468 447424001 -15002\nf 1 2 3\n";
  const auto model = load("mm.obj", text, {.metres_per_unit = 0.001, .up = "z", .shift = {-84616, 0, 447423}});
  ASSERT_TRUE(model) << model.error().message;
  const Box box = model->bounds();
  EXPECT_LT(glm::length(box.min - glm::dvec3(0.468, -15.002, -1.001)), 1e-6);
  EXPECT_LT(glm::length(box.max - glm::dvec3(1.468, -15.002, -0.001)), 1e-6);
}

TEST_F(LoadModelTest, BadOptionsAreNamedBeforeAnyWork) {
  EXPECT_EQ(load_model("nowhere.obj", {.up = "sideways"}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(load_model("nowhere.obj", {.metres_per_unit = -2}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(load_model("").error().code, ErrorCode::kInvalidArgument);
}

TEST_F(LoadModelTest, GeneratedScenesGoThroughTheSameDoor) {
  const auto model = load_model("pipes:2000:1", {.shift = {1000, 0, 0}});
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_NEAR(static_cast<double>(model->drawn_triangles()), 2000, 40);
  EXPECT_GE(model->bounds().min.x, 900);
  EXPECT_FALSE(load_model("teapots:2000:1"));
  EXPECT_EQ(load_model("pipes:many:1").error().code, ErrorCode::kInvalidArgument) << "badly written";
}

TEST_F(LoadModelTest, PathsThatAreNoModels) {
  EXPECT_EQ(load_model((folder_.path() / "gone.glb").string()).error().code, ErrorCode::kNotFound);
  EXPECT_THAT(load_model(folder_.path().string()).error().message, HasSubstr("not a file"));
  EXPECT_THAT(failure("empty.glb", ""), HasSubstr("empty"));
  EXPECT_THAT(failure("notes.txt", "hello"), HasSubstr("unknown kind of file '.txt'"));
  EXPECT_THAT(failure("zipped.obj", "\x1f\x8b\x08"), HasSubstr("compressed"));
}

TEST_F(LoadModelTest, FilesThatAreNotWhatTheySay) {
  EXPECT_THAT(failure("text.glb", "just some text"), HasSubstr("not a binary glTF file"));
  EXPECT_THAT(failure("text.gltf", "just some text"), HasSubstr("not JSON"));
  EXPECT_THAT(failure("text.ply", "just some text"), HasSubstr("not a PLY file"));
  EXPECT_THAT(failure("text.off", "just some text"), HasSubstr("not an OFF file"));
  EXPECT_THAT(failure("text.dae", "just some text"), HasSubstr("COLLADA importer says"));
  EXPECT_THAT(failure("text.obj", "just some text"), HasSubstr("holds no triangles"));
  EXPECT_THAT(failure("text.json", "just some text"), HasSubstr("JSON"));
}

TEST_F(LoadModelTest, HeadersThatPromiseTooMuch) {
  EXPECT_THAT(failure("t.ply",
                      "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty "
                      "float y\nproperty float z\nend_header\n0 0 0"),
              HasSubstr("claims 1000000000 elements, which need at least 12000000000 bytes"));
  EXPECT_THAT(failure("t.off", "OFF\n1000000000 1000000000 0\n0 0 0\n"),
              HasSubstr("claims 2000000000 vertices and faces"));
  std::string stl(84, '\0');
  stl[83] = 0x40;
  EXPECT_THAT(failure("t.stl", stl), HasSubstr("claims 1073741824 triangles"));
  EXPECT_THAT(
      failure("t.gltf", gltf(3, "{}", R"(,{"bufferView":0,"componentType":5126,"count":1000000000,"type":"VEC3"})")),
      HasSubstr("accessor 2 claims 1000000000 elements"));
  EXPECT_THAT(failure("t.glb", std::string("glTF\2\0\0\0\xff\xff\0\0\4\0\0\0JSON{}  ", 24)),
              HasSubstr("claims 65535 bytes but the file has 24"));
  EXPECT_THAT(failure("t.ifc", "ISO-10303-21;\nHEADER;\n"), HasSubstr("end mark"));
}

TEST_F(LoadModelTest, MissingDataFileIsNamed) {
  EXPECT_THAT(failure("t.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"gone.bin"}]})"),
              HasSubstr("gone.bin is not beside it"));
}

TEST_F(LoadModelTest, TrianglesThatAreAllBrokenAreAnError) {
  EXPECT_THAT(failure("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("every triangle is broken (dropped triangles with vertices that are not finite"));
}

TEST_F(LoadModelTest, TooLittleMemoryIsOneLine) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than any limit leaves";
#endif
  const auto model = load("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {.memory_limit_bytes = 1 << 20});
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().message.find('\n'), std::string::npos);
}

TEST_F(LoadModelTest, ElementsWithoutPropertiesAreNotCountedOneByOne) {
  const std::string message =
      failure("many.ply", "ply\nformat ascii 1.0\nelement vertex 1000000000\nelement face 1000000000\nend_header\n");
  EXPECT_THAT(message, HasSubstr("1000000000 elements"));
}

TEST_F(LoadModelTest, ListsThatClaimMoreThanTheFileHolds) {
  const std::string header = " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
                             "property uchar part\nproperty list uint int vertex_indices\nend_header\n";
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_THAT(failure("text.ply", "ply\nformat ascii" + header + vertices + "7 3 0 1 2\n7 1000000000 0 1 2\n"), HasSubstr("1000000000 values"));
  const auto model = load("good.ply", "ply\nformat ascii" + header + vertices + "7 3 0 1 2\n7 3 2 1 0\n");
  EXPECT_TRUE(model) << model.error().message;

  const auto binary = [&](std::uint32_t second_length) {
    std::string bytes = "ply\nformat binary_little_endian" + header;
    const auto put = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(v);
    for (const std::uint32_t length : {3u, second_length}) {
      put(std::uint8_t{7});
      put(length);
      for (const std::int32_t index : {0, 1, 2}) put(index);
    }
    return bytes;
  };
  EXPECT_THAT(failure("binary.ply", binary(1'000'000'000)), HasSubstr("1000000000 values"));
  EXPECT_TRUE(load("fine.ply", binary(3)));
}

TEST_F(LoadModelTest, BadlyWrittenGeneratedScenesAreNotCalledMissingFiles) {
  for (const char* text : {"pipes:-5:1", "pipes:1e99:1", "pipes:1000", "pipes:1000:", "pipes:1000:-1", "pipes:99999999999999999999:1"}) {
    const Result<Model> model = load_model(text);
    ASSERT_FALSE(model) << text;
    EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument) << text;
    EXPECT_THAT(model.error().message, HasSubstr("KIND:TRIANGLES:SEED"));
  }
  EXPECT_THAT(load_model("castle:0:1").error().message, HasSubstr("castle"));
  EXPECT_EQ(load_model("no:such/file.obj").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace farfield

// SPDX-License-Identifier: Apache-2.0
#include "server/model/obj_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/model/texture_file.h"
#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using testing::Contains;
using testing::HasSubstr;

class ObjReaderTest : public testing::Test {
 protected:
  Model read(std::string_view text) {
    Result<Model> model = read_obj(folder_.write("model.obj", text));
    EXPECT_TRUE(model.has_value());
    return model ? std::move(*model) : Model();
  }
  TemporaryFolder folder_;
};

TEST_F(ObjReaderTest, ReadsPolygonsWithEveryFormOfReference) {
  const Model model = read(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvt 1 1\nvn 0 0 1\n"
      "f 1/1/1 2/2/1 3/3/1\nf 1//1 3//1 4//1\nf -4 -3 -2 -1\n");
  EXPECT_EQ(model.drawn_triangles(), 4u);
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_TRUE(model.meshes[0].normals.empty()) << "one face has no normals: the mesh is shaded flat";
  ASSERT_FALSE(model.meshes[0].uvs.empty());
  EXPECT_FLOAT_EQ(model.meshes[0].uvs[1].y, 0.75f) << "v counts from the first image row here";
}

TEST_F(ObjReaderTest, GeoreferencedCoordinatesLoseNothing) {
  const glm::dvec3 corners[] = {
      {84616.468, 447423.001, -15.002}, {84617.127, 447423.999, 3.5}, {84616.5, 447430.003, 0.125}};
  std::string text;
  for (const glm::dvec3& c : corners) text += fmt::format("v {:.3f} {:.3f} {:.3f}\n", c.x, c.y, c.z);
  const Model model = read(text + "f 1 2 3\n");
  ASSERT_EQ(model.instances.size(), 1u);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 world(model.instances[0].world_from_mesh *
                           glm::dvec4(model.meshes[0].positions[static_cast<std::size_t>(i)], 1));
    // Floats of magnitude below 16 are 2^-20 apart: half of that is the error allowed.
    EXPECT_LT(glm::length(world - corners[i]), 1.0 / (1 << 19)) << i;
  }
}

TEST_F(ObjReaderTest, MeshesOfOneFileShareTheirSharedVerticesExactly) {
  const Model model = read(
      "v 84616.468 447423.001 0\nv 84617.127 447423.999 0\nv 84616.5 447430.003 0\nv 84990.1 447600.7 2\n"
      "g a\nf 1 2 3\ng b\nf 2 3 4\n");
  ASSERT_EQ(model.meshes.size(), 2u);
  EXPECT_EQ(model.instances[0].world_from_mesh, model.instances[1].world_from_mesh);
  EXPECT_EQ(model.meshes[0].positions[1], model.meshes[1].positions[0]);
}

TEST_F(ObjReaderTest, TriangulatesConcavePolygons) {
  const Model model = read("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\nf 1 2 3 4 5\n");
  ASSERT_EQ(model.drawn_triangles(), 3u);
  double area = 0;
  const Mesh& mesh = model.meshes[0];
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  EXPECT_NEAR(area, 2.5, 1e-6);
}

TEST_F(ObjReaderTest, ReadsMaterialsAndTheirTextures) {
  const TextureImage image{.width = 2, .height = 1, .rgba = {255, 0, 0, 255, 0, 0, 255, 255}};
  const Bytes png = encode_png(image).value();
  folder_.write("maps/wall one.png", {reinterpret_cast<const char*>(png.data()), png.size()});
  folder_.write("some.mtl",
                "newmtl red\nKd 1 0 0\nd 0.25\nnewmtl wall\nKd 0 0 0\nmap_Kd -s 1 1 1 -clamp on maps\\wall one.png\n"
                "newmtl lost\nTr 0\nmap_Kd nowhere.png\n");
  const Model model = read(
      "mtllib some.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl red\nf 1 2 3\nusemtl wall\nf 1 2 3\nusemtl lost\nf 3 2 "
      "1\nusemtl none\nf 1 3 2\n");
  ASSERT_EQ(model.meshes.size(), 4u);
  const auto material = [&](std::size_t mesh) {
    return model.materials[static_cast<std::size_t>(model.meshes[mesh].material)];
  };
  EXPECT_EQ(material(0).base_colour, glm::u8vec4(255, 0, 0, 64));
  EXPECT_TRUE(material(0).is_alpha_masked);
  ASSERT_EQ(material(1).texture, 0);
  EXPECT_EQ(material(1).base_colour, glm::u8vec4(255)) << "a black Kd under a map is not meant";
  EXPECT_EQ(model.textures.at(0).rgba, image.rgba);
  EXPECT_EQ(material(2).texture, -1);
  EXPECT_THAT(model.warnings, Contains(HasSubstr("nowhere.png")));
  EXPECT_THAT(model.warnings, Contains(HasSubstr("material 'none'")));
}

TEST_F(ObjReaderTest, OpacityMapsBecomeTheAlphaOfTheTexture) {
  const auto write_png = [&](const char* name, const TextureImage& image) {
    const Bytes png = encode_png(image).value();
    folder_.write(name, {reinterpret_cast<const char*>(png.data()), png.size()});
  };
  write_png("leaf.png", {.width = 1, .height = 1, .rgba = {0, 200, 0, 255}});
  write_png("mask.png", {.width = 2, .height = 1, .rgba = {255, 255, 255, 255, 0, 0, 0, 255}});
  write_png("holes.png", {.width = 2, .height = 1, .rgba = {9, 9, 9, 255, 9, 9, 9, 0}});
  folder_.write("some.mtl",
                "newmtl masked\nmap_Kd leaf.png\nmap_d -imfchan m mask.png\nnewmtl alone\nKd 1 0 0\nmap_d mask.png\n"
                "newmtl own\nmap_d holes.png\nmap_Kd holes.png\nnewmtl inverted\nmap_Kd leaf.png\nmap_Tr mask.png\n"
                "newmtl lost\nmap_Kd leaf.png\nmap_d nowhere.png\n");
  const Model model = read(
      "mtllib some.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl masked\nf 1 2 3\nusemtl alone\nf 1 2 3\nusemtl own\nf 1 2 "
      "3\nusemtl inverted\nf 1 2 3\nusemtl lost\nf 1 2 3\n");
  ASSERT_EQ(model.meshes.size(), 5u);
  const auto material = [&](std::size_t mesh) { return model.materials[static_cast<std::size_t>(model.meshes[mesh].material)]; };
  const auto texels = [&](std::size_t mesh) { return model.textures.at(static_cast<std::size_t>(material(mesh).texture)).rgba; };
  using Texels = std::vector<std::uint8_t>;
  EXPECT_EQ(texels(0), (Texels{0, 200, 0, 255, 0, 200, 0, 0}));
  EXPECT_TRUE(material(0).is_alpha_masked);
  EXPECT_EQ(texels(1), (Texels{255, 255, 255, 255, 255, 255, 255, 0})) << "the colour stays Kd's";
  EXPECT_EQ(material(1).base_colour, glm::u8vec4(255, 0, 0, 255));
  EXPECT_EQ(texels(2), (Texels{9, 9, 9, 255, 9, 9, 9, 0})) << "its own alpha, once";
  EXPECT_EQ(texels(3), (Texels{0, 200, 0, 0, 0, 200, 0, 255}));
  EXPECT_EQ(texels(4), (Texels{0, 200, 0, 255}));
  EXPECT_THAT(model.warnings, Contains(HasSubstr("opacity map nowhere.png")));
}

TEST_F(ObjReaderTest, ToleratesWhatIsBroken) {
  const Model model = read(
      "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 x\nv 0 1\nf 1 2 9\nf 1 0 2\nf 1 2\nl 1 2\np 1\nf 1 2 \\\n 4\nf a b "
      "c\nv\n");
  EXPECT_EQ(model.drawn_triangles(), 1u) << "the continued line";
  EXPECT_THAT(model.warnings, Contains(HasSubstr("gone.mtl")));
  EXPECT_THAT(model.warnings, Contains("dropped faces that name missing vertices (the first in line 6): 3"));
  EXPECT_THAT(model.warnings, Contains("dropped lines, points and faces with fewer than three corners: 3"));
  EXPECT_THAT(model.warnings, Contains("coordinates that are not numbers: 5"));
}

TEST_F(ObjReaderTest, ReadsVertexColours) {
  const Model model = read("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 0.5\nf 1 2 3\n");
  ASSERT_EQ(model.meshes.at(0).colours.size(), 3u);
  EXPECT_EQ(model.meshes[0].colours[0], glm::u8vec4(255, 0, 0, 255));
  EXPECT_EQ(model.meshes[0].colours[2], glm::u8vec4(0, 0, 128, 255));
}

TEST_F(ObjReaderTest, ReadsUtf16) {
  const std::string ascii = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  std::string wide = "\xfe\xff";
  for (const char c : ascii) wide += std::string({'\0', c});
  EXPECT_EQ(read(wide).drawn_triangles(), 1u);
}

TEST(ObjReader, NamesAMissingOrEmptyFile) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_obj(folder.path() / "none.obj").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(read_obj(folder.write("empty.obj", "")).error().code, ErrorCode::kBadData);
  EXPECT_EQ(read_obj(folder.path()).error().code, ErrorCode::kBadData);
}

}  // namespace
}  // namespace farfield

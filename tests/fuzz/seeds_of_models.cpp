// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>
#include <unistd.h>

#include "server/model/model_stream.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/seeds.h"

namespace farfield::fuzz {
namespace {

constexpr const char* kObj = R"(# every kind of line
mtllib model.mtl
o room
v 0 0 0 1 0.5 0.25
v 4 0 0
v 4 0 4
v 0 0 4
v 2 3 2
vt 0 0
vt 1 0
vt 1 1
vn 0 1 0
g floor
usemtl brick
f 1/1/1 2/2/1 3/3/1 4/1/1
usemtl plain
f -5 -4 -1
f 2//1 3//1 5//1
l 1 2 3
p 4
)";

constexpr const char* kMtl = R"(newmtl brick
Kd 0.7 0.3 0.2
d 0.9
map_Kd -s 2 2 1 brick.png
newmtl glass
Kd 1 1 1
Tr 0.8
map_d leaf.png
)";

constexpr const char* kCityJson = R"({"type":"CityJSON","version":"2.0",
"transform":{"scale":[0.001,0.001,0.001],"translate":[84616.4,447423.0,-1.5]},
"CityObjects":{"house":{"type":"Building","geometry":[{"type":"Solid","lod":"2.2",
"boundaries":[[[[0,3,2,1]],[[0,1,4]],[[1,2,4]],[[2,3,4]],[[3,0,4],[0,1,2]]]],
"semantics":{"surfaces":[{"type":"GroundSurface"},{"type":"RoofSurface"}],"values":[[0,1,1,1,1]]}}]},
"part":{"type":"BuildingPart","parents":["house"],"geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]}},
"vertices":[[0,0,0],[4000,0,0],[4000,4000,0],[0,4000,0],[2000,2000,3000]]})";

constexpr const char* kCitySequence =
    R"({"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{},"vertices":[]}
{"type":"CityJSONFeature","id":"a","CityObjects":{"a":{"type":"Road","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]}},"vertices":[[0,0,0],[1,0,0],[0,1,0]]}
)";

constexpr const char* kGltf = R"({"asset":{"version":"2.0"},
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})";

constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
constexpr const char* kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
constexpr const char* kIfc = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=IFCPERSON($,$,'',$,$,$,$,$);\nENDSEC;\nEND-ISO-10303-21;\n";

Bytes glb() {
  std::string json = kGltf;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  ByteWriter writer;
  writer.put(std::uint32_t{0x46546c67});  // "glTF"
  writer.put(std::uint32_t{2});
  writer.put(static_cast<std::uint32_t>(20 + json.size()));
  writer.put(static_cast<std::uint32_t>(json.size()));
  writer.put(std::uint32_t{0x4e4f534a});  // "JSON"
  writer.put_bytes(bytes_of(json));
  return writer.take();
}

Bytes binary_stl() {
  ByteWriter writer;
  writer.put_bytes(Bytes(80, ' '));
  writer.put(std::uint32_t{1});
  for (int i = 0; i < 12; ++i) writer.put(i == 6 || i == 10 ? 1.0f : 0.0f);
  writer.put(std::uint16_t{0});
  return writer.take();
}

Model small_model() {
  Model model;
  model.name = "small";
  model.warnings = {"one"};
  model.textures.push_back({2, 1, {1, 2, 3, 4, 5, 6, 7, 8}, "t"});
  model.materials.push_back({"m", {9, 8, 7, 6}, 0, true, 0.25f});
  Mesh mesh;
  mesh.name = "mesh";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.uvs.assign(3, {0.5f, 0.25f});
  mesh.colours.assign(3, glm::u8vec4(200));
  mesh.indices = {0, 1, 2};
  model.meshes = {mesh};
  model.instances = {{0, glm::dmat4(1)}, {0, glm::dmat4(2)}};
  return model;
}

Bytes streamed(const Model& model) {
  const int descriptor = memfd_create("seed", 0);
  require(descriptor >= 0 && write_model_stream(model, descriptor).has_value(), "a model can be handed over");
  Bytes bytes(static_cast<std::size_t>(lseek(descriptor, 0, SEEK_END)));
  require(pread(descriptor, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()), "and read back");
  close(descriptor);
  return bytes;
}

}  // namespace

void add_model_seeds(Seeds& seeds) {
  seeds.push_back({"obj", "every_line", bytes_of(kObj)});
  seeds.push_back({"obj", "one_triangle", bytes_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")});
  seeds.push_back({"obj", "concave", bytes_of("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nv 1 1 1\nf 1 2 3 4 5\n")});
  seeds.push_back({"mtl", "two_materials", bytes_of(kMtl)});
  seeds.push_back({"city_json", "house", bytes_of(kCityJson)});
  seeds.push_back({"city_json", "sequence", bytes_of(kCitySequence)});
  seeds.push_back({"model_stream", "small", streamed(small_model())});
  seeds.push_back({"model_stream", "empty", streamed({})});
  // In the order of fuzz_file_claims' files.
  seeds.push_back({"file_claims", "glb", chosen(0, glb())});
  seeds.push_back({"file_claims", "gltf", chosen(1, bytes_of(kGltf))});
  seeds.push_back({"file_claims", "ply", chosen(2, bytes_of(kPly))});
  seeds.push_back({"file_claims", "stl", chosen(3, binary_stl())});
  seeds.push_back({"file_claims", "off", chosen(4, bytes_of(kOff))});
  seeds.push_back({"file_claims", "ifc", chosen(5, bytes_of(kIfc))});
}

}  // namespace farfield::fuzz
